// SPDX-License-Identifier: BSD-3-Clause
// A posture for the null space of the tool, as a law of its own.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/detail/row.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/kinematics/damped_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `tau = M (1 - J^+ J) (-w^2 (q - q_p) - 2 w dq)`: a critically damped pull to the posture `q_p` in the null
/// space of the tool: it accelerates the tool nowhere (`J M^-1 tau = 0` where J^+ is not damped). For robots
/// with more joints than the tool's task has coordinates, in a sum with laws that leave the null space free.
/// Each joint's pull `w^2 (q - q_p)` saturates smoothly at `limit`.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double,
          TaskSpace What = TaskSpace::position>
class NullSpacePosture : public StatelessLaw<NullSpacePosture<N, Ix, P, T, What>> {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  static constexpr Needs needs = {.jacobians = link_bit<Ix>, .mass = true};
  static constexpr const char* name = "posture";

  /// @param w      natural frequency of the pull [1/s], > 0; `w dt <= 0.25`.
  /// @param limit  largest pull of a joint [rad/s^2], > 0. Throws `ConfigurationError` for numbers out of
  ///               range.
  NullSpacePosture(const Transform<Link<Ix>, P, T>& X_LP, const JointPosition<N, T>& posture,
                   const T& w = T(3), const T& limit = T(5),
                   const SingularityDamping<T>& singularities = SingularityDamping<T>())
      : X_LP_(X_LP), posture_(posture), w_(w), limit_(limit), singularities_(singularities) {
    require(w > T(0) && w <= T(1e3), "w of a posture", static_cast<double>(w), "> 0 1/s");
    require(limit > T(0) && limit <= T(1e6), "limit of a posture", static_cast<double>(limit), "> 0 rad/s^2");
  }
  template <class K>
  [[nodiscard]] JointTorque<N, T> torque(const K& known) const noexcept {
    const auto J = known.template jacobian<Ix>(X_LP_);
    const auto inverse = damped_inverse<What>(J, singularities_);
    using R = detail::Row<N, T>;
    const R pull = T(w_ * w_) * (R(known.q()) - posture_), limit = limit_;
    const JointAcceleration<N, T> a(-limit * pull / (limit + magnitude(pull)) - T(T(2) * w_) * R(known.dq()));
    const auto seen = inverse.solve(J * a);
    return known.mass() * (a - seen);
  }

 private:
  Transform<Link<Ix>, P, T> X_LP_;
  JointPosition<N, T> posture_;
  T w_, limit_;
  SingularityDamping<T> singularities_;
};

SKINCTL_END_NAMESPACE
