// SPDX-License-Identifier: BSD-3-Clause
// The inertia of the motors' rotors, reflected to the joints.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rotor inertia per joint, reflected through the gear [kg m^2]: it adds to the diagonal of M. Zero by
/// default. A gear of 100 turns a rotor's 1e-5 kg m^2 into 0.1, more than the links themselves on wrist
/// joints.
///
/// Only the spin relative to the joint's own link counts; the rotor's mass belongs to the link that carries
/// the motor, and gyroscopic terms are left out (small for gears of 50 and more).
template <std::size_t N, Scalar T = double>
class RotorInertia {
 public:
  RotorInertia() = default;
  /// @param motor  inertia of each rotor about its own axis [kg m^2], >= 0.
  /// @param ratio  turns of the rotor per turn of the joint, any sign. Throws `ConfigurationError`.
  RotorInertia(const std::array<T, N>& motor, const std::array<T, N>& ratio) {
    for (std::size_t i = 0; i < N; ++i) {
      at_joint_[i] = motor[i] * ratio[i] * ratio[i];
      if constexpr (Real<T>)
        require(at_joint_[i] >= T(0) && at_joint_[i] <= (std::numeric_limits<T>::max)(),
                "RotorInertia: inertia at the joint", static_cast<double>(at_joint_[i]), ">= 0 kg m^2");
    }
  }
  /// Reflected inertia at joint `i` [kg m^2].
  [[nodiscard]] SKINCTL_INLINE const T& operator[](std::size_t i) const noexcept { return at_joint_[i]; }

  /// The mass matrix with the rotors added [kg m^2].
  [[nodiscard]] friend SKINCTL_INLINE MassMatrix<N, T> operator+(MassMatrix<N, T> M,
                                                                 const RotorInertia& rotors) noexcept {
    for (std::size_t i = 0; i < N; ++i) M(i, i) = M(i, i) + rotors[i];
    return M;
  }
  /// The torque that accelerates the rotors [N m], to be added to inverse dynamics.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> operator*(
      const JointAcceleration<N, T>& ddq) const noexcept {
    return JointTorque<N, T>::generate([&](std::size_t i)
                                           SKINCTL_INLINE_LAMBDA { return T(at_joint_[i] * ddq[i]); });
  }
  /// Kinetic energy of the rotors' spin [J].
  [[nodiscard]] friend SKINCTL_INLINE T kinetic_energy(const RotorInertia& rotors,
                                                       const JointVelocity<N, T>& dq) noexcept {
    T sum(0);
    for (std::size_t i = 0; i < N; ++i) sum = sum + rotors[i] * dq[i] * dq[i];
    return T(0.5) * sum;
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // rotors take joint accelerations: rotors * ddq
  // clang-format on

 private:
  T at_joint_[N] = {};
};

SKINCTL_END_NAMESPACE
