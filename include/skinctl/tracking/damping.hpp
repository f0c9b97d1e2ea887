// SPDX-License-Identifier: BSD-3-Clause
// The matrix K_d of eq. (8): in proportion to the mass matrix, or constant.
#pragma once

#include <array>
#include <limits>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/mass_ratio.hpp"
#include "skinctl/law/needs.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The damping torque `K_d v`, and the diagonal of K_d.
template <std::size_t N, Real T = double>
struct DampingTorque {
  JointTorque<N, T> torque;  ///< damping torque `K_d v` [N m]
  JointTorque<N, T> own;     ///< diagonal of K_d: damping of each joint by its own velocity [N m s/rad]
};

/// `K_d = lambda M(q)`: `S_q = dq - dq_r` of every joint, eq. (9), decays at the same rate lambda [1/s], the
/// Lyapunov function as `dV = -2 lambda V`, and the torque of eq. (8) is one recursion.
template <Real T = double>
class InertialDamping {
 public:
  static constexpr Needs needs = {};
  /// @param lambda  decay rate of `S_q = dq - dq_r` [1/s]; checked with the other gains.
  explicit InertialDamping(const T& lambda) noexcept : lambda_(lambda) {}

  /// The largest decay rate of `S_q = dq - dq_r` [1/s].
  [[nodiscard]] const T& fastest() const noexcept { return lambda_; }
  /// The smallest decay rate of `S_q = dq - dq_r` [1/s].
  [[nodiscard]] const T& slowest() const noexcept { return lambda_; }

  /// The acceleration `M^-1 K_d S_q` [rad/s^2], which goes into the recursion.
  template <class K, std::size_t N>
  [[nodiscard]] SKINCTL_INLINE JointAcceleration<N, T> acceleration(
      const K&, const JointVelocity<N, T>& S_q) const noexcept {
    return JointAcceleration<N, T>(lambda_ * detail::Row<N, T>(S_q));
  }
  /// `K_d v` [N m] and the diagonal of K_d, with `motors`, the motors' inertia at the joints [kg m^2], added
  /// to M.
  template <class K, std::size_t N>
  [[nodiscard]] SKINCTL_NOINLINE DampingTorque<N, T> torque(const K& known, const JointTorque<N, T>& motors,
                                                            const JointVelocity<N, T>& v) const noexcept {
    DampingTorque<N, T> out;
    const auto mass = mass_matrix(known.model(), known.q());
    for (std::size_t i = 0; i < N; ++i) {
      T sum = motors[i] * v[i];
      for (std::size_t j = 0; j < N; ++j) sum = sum + mass(i, j) * v[j];
      out.torque[i] = lambda_ * sum;
      out.own[i] = lambda_ * (mass(i, i) + motors[i]);
    }
    return out;
  }

 private:
  T lambda_;
};

/// A constant symmetric positive definite K_d. The joint with the smallest inertia bounds all of it: on a UR5
/// `K_d = k 1` has to be so small for the wrist that the shoulder hardly tracks.
/// Include `<Eigen/Eigenvalues>` to use it.
template <std::size_t N, Real T = double>
class ConstantDamping {
 public:
  static constexpr Needs needs = {.mass = true};

  /// @param model  the robot; the decays of `S_q = dq - dq_r` [1/s] are eigenvalues of M(q)^-1 K_d over 256
  ///               poses within +-pi, which the law's constructor checks together with the other gains.
  /// @param K_d    row by row [N m s/rad]. Throws `ConfigurationError` if it is not symmetric (to
  ///               `tolerance<T>` of its largest element) or not positive definite.
  template <RobotModel M>
  ConstantDamping(const M& model, const std::array<T, N * N>& K_d) {
    static_assert(M::joints == N, "one row per joint");
    T largest(0);
    for (std::size_t i = 0; i < N * N; ++i) {
      const T size = K_d[i] < T(0) ? T(-K_d[i]) : K_d[i];
      require(size <= T(1e9), "element of K_d", static_cast<double>(K_d[i]), "finite");
      if (size > largest) largest = size;
      K_d_[i] = K_d[i];
    }
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const T gap = K_d[i * N + j] - K_d[j * N + i];
        require((gap < T(0) ? T(-gap) : gap) <= tolerance<T> * largest, "K_d(i,j) - K_d(j,i)",
                static_cast<double>(gap), "0: symmetric");
      }
    const Square gain = as_square(K_d_);
    const T least = Eigen::SelfAdjointEigenSolver<Square>(gain, values_only).eigenvalues()(0);
    require(least > T(0), "smallest eigenvalue of K_d", static_cast<double>(least), "> 0: positive definite");
    slowest_ = std::numeric_limits<T>::infinity();
    detail::each_pose<poses, N, T>([&](const JointPosition<N, T>& q) {
      const auto rates = rates_of(gain, mass_matrix(model, q));
      if (rates(N - 1) > fastest_) fastest_ = rates(N - 1);
      if (rates(0) < slowest_) slowest_ = rates(0);
    });
  }

  /// The largest decay rate of `S_q = dq - dq_r` [1/s] over 256 poses.
  [[nodiscard]] const T& fastest() const noexcept { return fastest_; }
  /// The smallest decay rate of `S_q = dq - dq_r` [1/s] over 256 poses.
  [[nodiscard]] const T& slowest() const noexcept { return slowest_; }

  /// The damping torque `K_d S_q` [N m].
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const JointVelocity<N, T>& S_q) const noexcept {
    JointTorque<N, T> tau;
    for (std::size_t i = 0; i < N; ++i) {
      T sum(0);
      for (std::size_t j = 0; j < N; ++j) sum = sum + K_d_[i * N + j] * S_q[j];
      tau[i] = sum;
    }
    return tau;
  }
  /// The damping torque `K_d v` [N m], and the diagonal of K_d; the motors' inertia plays no part.
  template <class K>
  [[nodiscard]] SKINCTL_NOINLINE DampingTorque<N, T> torque(const K&, const JointTorque<N, T>&,
                                                            const JointVelocity<N, T>& v) const noexcept {
    DampingTorque<N, T> out{torque(v), {}};
    for (std::size_t i = 0; i < N; ++i) out.own[i] = K_d_[i * N + i];
    return out;
  }
  /// The acceleration `M^-1 K_d S_q` [rad/s^2]; zero where M cannot be factorised.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointAcceleration<N, T> acceleration(
      const K& known, const JointVelocity<N, T>& S_q) const noexcept {
    const auto tau = torque(S_q);
    JointAcceleration<N, T> a;
    const math::Ldlt<N, T> factors(known.mass().data);
    if (factors.positive_definite()) factors.solve(tau.data, a.data);
    return a;
  }

 private:
  using Square = EigenMatrix<T, int(N), int(N)>;
  /// Number of poses for the decays; the gains' margin of two is for those in between.
  static constexpr int poses = 256;
  static constexpr int values_only = 0x40;  // Eigen::EigenvaluesOnly

  static Square as_square(const T (&rows)[N * N]) {
    Square m;
    for (std::size_t i = 0; i < N * N; ++i) m(static_cast<std::ptrdiff_t>(i)) = rows[i];  // symmetric
    return m;
  }
  /// Eigenvalues of M^-1 K_d, the smallest first.
  static EigenMatrix<T, int(N), 1> rates_of(const Square& gain, const MassMatrix<N, T>& mass) {
    const Square m = as_square(mass.data);
    const T least = Eigen::SelfAdjointEigenSolver<Square>(m, values_only).eigenvalues()(0);
    require(least > T(0), "smallest eigenvalue of M(q)", static_cast<double>(least),
            "> 0: every joint needs inertia");
    // 0x100: Eigen::Ax_lBx
    return Eigen::GeneralizedSelfAdjointEigenSolver<Square>(gain, m, values_only | 0x100).eigenvalues();
  }

  T K_d_[N * N];
  T fastest_ = T(0), slowest_ = T(0);
};

SKINCTL_END_NAMESPACE
