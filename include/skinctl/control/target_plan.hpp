// The target of Joint Control: positions and velocities from outside, section 4.2.1.
#pragma once

#include "skinctl/control/settings.hpp"
#include "skinctl/core/evaluate.hpp"
#include "skinctl/trajectory/plan_clock.hpp"
#include "skinctl/trajectory/spline.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The last target that came, and for how long it has been the last; trivially copyable.
///
/// A moving target goes on as it came, `q_d + x dq_d + x^2/2 ddq_d`, for `target_age`; then its time slows
/// down over as long again and stops: a source that falls silent leaves the robot at rest, half of
/// `target_age` further.
template <std::size_t N, Real T = double>
struct TargetPlan {
  using Goal = JointReference<N, T>;
  static constexpr bool streams = true;

  JointReference<N, T> target;
  PlanClock<T> clock;  ///< time since it came
  bool aged = false;   ///< it has become too old, and slows down

  [[nodiscard]] static SKINCTL_INLINE constexpr TargetPlan standing(
      const JointPosition<N, T>& q, const JointControlSettings<N, T>&) noexcept {
    return {{q, {}, {}}, {}, false};
  }
  /// The target `x` seconds from now.
  [[nodiscard]] SKINCTL_INLINE JointReference<N, T> at(const T& x,
                                                       const JointControlSettings<N, T>& s) const noexcept {
    const auto own = clock.at(x, s.target_age);
    const detail::Row<N, T> q = target.q_d, dq = target.dq_d, ddq = target.ddq_d, v = dq + own.t * ddq;
    return {JointPosition<N, T>(q + own.t * (dq + T(T(0.5) * own.t) * ddq)),
            JointVelocity<N, T>(own.rate * v),
            JointAcceleration<N, T>(own.bend * v + T(own.rate * own.rate) * ddq)};
  }
  [[nodiscard]] SKINCTL_INLINE constexpr TargetPlan advanced(
      Nanoseconds dt, const JointControlSettings<N, T>& s) const noexcept {
    const auto next = clock.advanced(dt, s.target_age);
    if (aged || seconds<T>(next.own) < s.target_age) return {target, next, aged};
    return {target, next.changed(false, s.target_age), true};
  }
  /// The target comes from outside, where its time is not ours to hold.
  [[nodiscard]] SKINCTL_INLINE constexpr TargetPlan held(bool,
                                                         const JointControlSettings<N, T>&) const noexcept {
    return *this;
  }

  /// The new target. One that is not finite, or itself faster than `max_velocity`, is refused.
  [[nodiscard]] Received<TargetPlan> to(const Goal& goal, const JointPosition<N, T>&,
                                        const JointControlSettings<N, T>& s) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const T v = goal.dq_d[i];
      const T sum = goal.q_d[i] + v + goal.ddq_d[i];
      if (!(sum - sum == T(0)) || !((v < T(0) ? T(-v) : v) < s.max_velocity[i]))
        return {*this, Reason::goal_refused};
    }
    return {{goal, {}, false}, {}};
  }
};

SKINCTL_END_NAMESPACE
