// The target of Spline Joint Control: a static goal, reached by a spline, section 4.2.4.
#pragma once

#include "skinctl/control/settings.hpp"
#include "skinctl/core/evaluate.hpp"
#include "skinctl/trajectory/plan_clock.hpp"
#include "skinctl/trajectory/spline.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Where to go, and in what time.
template <std::size_t N, Scalar T = double>
struct JointGoal {
  JointPosition<N, T> q_g;
  Nanoseconds duration = 0;  ///< from the moment of reception; 0: as long as `max_velocity` asks for
};

/// A spline under way; trivially copyable.
template <std::size_t N, Real T = double>
struct SplinePlan {
  using Goal = JointGoal<N, T>;
  static constexpr bool streams = false;

  JointSpline<N, T> spline;
  PlanClock<T> clock;

  /// Standing at `q`.
  [[nodiscard]] static SKINCTL_INLINE constexpr SplinePlan standing(
      const JointPosition<N, T>& q, const JointControlSettings<N, T>&) noexcept {
    return {{q, q, T(0)}, {}};
  }
  /// The reference `x` seconds from now.
  [[nodiscard]] SKINCTL_INLINE JointReference<N, T> at(const T& x,
                                                       const JointControlSettings<N, T>& s) const noexcept {
    const auto own = clock.at(x, s.hand_over);
    const auto r = spline.at(own.t);
    const detail::Row<N, T> dq_d = r.dq_d, ddq_d = r.ddq_d;
    return {r.q_d, JointVelocity<N, T>(own.rate * dq_d),
            JointAcceleration<N, T>(T(own.rate * own.rate) * ddq_d + own.bend * dq_d)};
  }
  [[nodiscard]] SKINCTL_INLINE constexpr SplinePlan advanced(
      Nanoseconds dt, const JointControlSettings<N, T>& s) const noexcept {
    return {spline, clock.advanced(dt, s.hand_over)};
  }
  /// The spline comes to a stop, or goes on.
  [[nodiscard]] SKINCTL_INLINE constexpr SplinePlan held(bool holds,
                                                         const JointControlSettings<N, T>& s) const noexcept {
    return {spline, clock.changed(!holds, s.hand_over)};
  }

  /// A spline from `q` to the goal. Its peak speed must keep below `max_velocity`, and it lasts 10 intervals
  /// or longer: it is stretched, or refused. A goal that is not finite is refused.
  [[nodiscard]] Received<SplinePlan> to(const Goal& goal, const JointPosition<N, T>& q,
                                        const JointControlSettings<N, T>& s) const noexcept {
    T least = T(10) * s.dt;
    for (std::size_t i = 0; i < N; ++i) {
      const T distance = goal.q_g[i] - q[i];
      if (!(distance - distance == T(0))) return {*this, Reason::goal_refused};
      const T time = shortest_spline_time(distance, s.max_velocity[i]);
      if (time > least) least = time;
    }
    const T asked = seconds<T>(goal.duration);
    if (goal.duration < 0 || !(least < T(1e9))) return {*this, Reason::goal_refused};
    const PlanClock<T> begun{0, clock_end, clock.to, clock.to};  // a held plan stays so
    if (asked >= least) return {{{q, goal.q_g, asked}, begun}, {}};
    if (goal.duration > 0 && s.reach == Reach::refuse) return {*this, Reason::goal_refused};
    return {{{q, goal.q_g, least}, begun}, goal.duration > 0 ? Status(Reason::goal_stretched) : Status{}};
  }
};

SKINCTL_END_NAMESPACE
