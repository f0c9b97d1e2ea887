// SPDX-License-Identifier: BSD-3-Clause
// Friction in the joints.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/math/tanh.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Viscous, Coulomb and Stribeck friction of joints, smooth at rest:
///
///     tau = b v + (tau_c + tau_s / (1 + (v / v_s)^2)) tanh(v / v_0)
///
/// is the torque that friction takes from a joint moving at v (to be added to the torque of a motion). The
/// Stribeck term is that of Hess and Soom (1990), without an exponential. Friction never drives:
/// `tau . v >= 0`.
///
/// `v_0` smooths the sign: below it a joint creeps instead of sticking, so a robot stays in place only under
/// a law that holds it. The slope at rest is `b + (tau_c + tau_s) / v_0`: for explicit integration this times
/// the time step must be less than the joint's inertia.
template <std::size_t N, Scalar T = double>
class JointFriction {
 public:
  struct Settings {
    JointTorque<N, T> viscous;                  ///< coefficient b of viscous friction [N m s/rad], >= 0
    JointTorque<N, T> coulomb;                  ///< Coulomb friction tau_c [N m], >= 0
    JointTorque<N, T> stiction;                 ///< stiction tau_s: breakaway torque minus tau_c [N m], >= 0
    T stribeck_velocity = static_cast<T>(0.1);  ///< speed v_s at which tau_s is halved [rad/s], > 0
    T sign_velocity = static_cast<T>(0.01);     ///< speed v_0 that smooths the sign [rad/s], > 0
  };

  /// Throws `ConfigurationError` for a number out of its range.
  explicit JointFriction(const Settings& settings) : s_(settings) {
    if constexpr (Real<T>) {
      for (std::size_t i = 0; i < N; ++i) {
        not_negative(s_.viscous[i], "JointFriction: viscous");
        not_negative(s_.coulomb[i], "JointFriction: coulomb");
        not_negative(s_.stiction[i], "JointFriction: stiction");
      }
      positive(s_.stribeck_velocity, "JointFriction: stribeck_velocity");
      positive(s_.sign_velocity, "JointFriction: sign_velocity");
    }
    per_stribeck_ = T(1) / s_.stribeck_velocity;
    per_sign_ = T(1) / s_.sign_velocity;
  }

  /// The torque of friction at `dq` [N m], with the sign of dq.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const JointVelocity<N, T>& dq) const noexcept {
    T x[N], sign[N];
    for (std::size_t i = 0; i < N; ++i) x[i] = dq[i] * per_sign_;
    math::tanh<N>(static_cast<const T*>(x), sign);
    return JointTorque<N, T>::generate([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const T r = dq[i] * per_stribeck_;
      return T(s_.viscous[i] * dq[i] + (s_.coulomb[i] + s_.stiction[i] / (T(1) + r * r)) * sign[i]);
    });
  }
  /// The slope of the friction torque, `d tau / d dq` [N m s/rad], for implicit integrators; negative on the
  /// falling side of the hump.
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> slope(const JointVelocity<N, T>& dq) const noexcept {
    T x[N], sign[N];
    for (std::size_t i = 0; i < N; ++i) x[i] = dq[i] * per_sign_;
    math::tanh<N>(static_cast<const T*>(x), sign);
    return JointTorque<N, T>::generate([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const T r = dq[i] * per_stribeck_;
      const T part = T(1) / (T(1) + r * r);
      const T hump = s_.stiction[i] * part;
      return T(s_.viscous[i] + (s_.coulomb[i] + hump) * (T(1) - sign[i] * sign[i]) * per_sign_ -
               T(2) * hump * part * r * per_stribeck_ * sign[i]);
    });
  }

 private:
  static void not_negative(const T& x, const char* name) {
    require(x >= T(0) && x <= (std::numeric_limits<T>::max)(), name, static_cast<double>(x), ">= 0");
  }
  static void positive(const T& x, const char* name) {
    const T most = (std::numeric_limits<T>::max)();
    require(x > T(0) && x <= most && T(1) / x <= most, name, static_cast<double>(x),
            "> 0, with a finite inverse");
  }

  Settings s_;
  T per_stribeck_, per_sign_;
};

SKINCTL_END_NAMESPACE
