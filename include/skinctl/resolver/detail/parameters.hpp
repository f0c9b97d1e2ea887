// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a robot's description as a resolver uses them: checked, completed, in seconds.
#pragma once

#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <std::size_t N, Real T>
struct ResolverParameters {
  JointLimits<N, T> limits;
  VirtualDynamics<N, T> shape;
  JointPosition<N, T> dead_band;  ///< B0: dead band [rad]
  JointPosition<N, T> owed;       ///< A d (tau + d/2), see `RobotConfiguration::owed_by_acceleration` [rad]
  JointVelocity<N, T> resting_speed;  ///< speed up to which a joint counts as at rest [rad/s]
  Nanoseconds period, delay, substep, longest_interval, stale_after;
  T cycle;        ///< the period [s]
  T torque_rate;  ///< largest rate of a law's own torque [torque limits per second]
  T largest_gap;  ///< largest gap that is borne [rad]
  T lag;          ///< tau: declared lag [s]
  T total_delay;  ///< T: delay, lag and period together [s]
  T latest;       ///< T with the undeclared lag that is borne [s]
  T per_held;     ///< 1/(5 T): inverse of the time after which a held joint counts as blocked [1/s]
  T reaction;     ///< longest time for which a velocity may be held [s]
  T undeclared;   ///< t_u: undeclared lag that is borne [s]
  T drift;        ///< rate at which joints by velocity drift to their measured positions [1/s]
  bool has_coulomb = false;

  /// The largest change of a law's own torque in `h` seconds [N m].
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque_step(const T& h) const noexcept {
    return T(torque_rate * h) * limits.torque();
  }
  [[nodiscard]] T planned_step() const noexcept { return seconds<T>(planned_substep(period, substep)); }

  SKINCTL_COLD explicit ResolverParameters(const RobotConfiguration<N, T>& c, bool has_virtual_robot = true)
      : limits(c.limits),
        shape(c.virtual_dynamics()),
        dead_band(c.dead_band),
        owed(c.owed_by_acceleration()),
        resting_speed(c.resting_speed()),
        period(c.period),
        delay(c.delay),
        substep(c.substep),
        longest_interval(c.longest()),
        stale_after(c.stale()),
        cycle(seconds<T>(c.period)),
        torque_rate(c.torque_rate),
        largest_gap(c.largest_gap),
        lag(seconds<T>(c.lag)),
        total_delay(seconds<T>(c.total_delay())),
        latest(seconds<T>(c.latest())),
        per_held(T(1) / (T(settled_delays) * total_delay)),
        reaction(seconds<T>(c.longest())),
        undeclared(seconds<T>(c.undeclared_lag)),
        lag_of_robot_(c.lag),
        undeclared_lag_(c.undeclared_lag) {
    check(c, has_virtual_robot);
    const T stable = T(gain_times_delay) / total_delay;
    drift = c.drift.value_or(stable < T(calm_drift) ? stable : T(calm_drift));
    for (std::size_t i = 0; i < N; ++i) has_coulomb = has_coulomb || shape.coulomb[i] > T(0);
  }

  /// The part of the robot's configuration that a guard reads.
  [[nodiscard]] RobotConfiguration<N, T> for_guard() const {
    return {.limits = limits,
            .period = period,
            .delay = delay,
            .lag = lag_of_robot_,
            .dead_band = dead_band,
            .undeclared_lag = undeclared_lag_,
            .longest_interval = longest_interval,
            .stale_after = stale_after};
  }

 private:
  /// Fastest drift by default [1/s]: a gap of 50 mrad then moves joints at 10 mrad/s, which nobody notices.
  static constexpr double calm_drift = 0.2;

  Nanoseconds lag_of_robot_, undeclared_lag_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
