// The numbers of a robot's description as a resolver uses them: checked, completed, in seconds.
#pragma once

#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <std::size_t N, Real T>
struct ResolverParameters {
  JointLimits<N, T> limits;
  VirtualDynamics<N, T> shape;
  JointPosition<N, T> dead_band;
  JointPosition<N, T> max_lead;  ///< e_max
  JointVelocity<N, T> resting_speed;
  Nanoseconds period, delay, substep, longest_interval, stale_after;
  Nanoseconds fresh_for;  ///< age up to which the residual of a measurement is used
  T cycle;                ///< the period [s]
  T settle;               ///< time in which a robot's answer shows in full [s]
  T forgets;              ///< share of what came before that is left after a period
  T torque_rate;          ///< [1/s]
  T largest_gap;          ///< to which a user can agree [rad]
  T lag, total_delay, per_delay, L1, L2, drift, retry, catch_up;
  bool has_coulomb = false;

  /// The largest change of a law's own torque in `h` seconds [N m].
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque_step(const T& h) const noexcept {
    return T(torque_rate * h) * limits.torque();
  }
  [[nodiscard]] T planned_step() const noexcept { return seconds<T>(planned_substep(period, substep)); }

  SKINCTL_COLD explicit ResolverParameters(const RobotConfiguration<N, T>& c, bool has_virtual_robot = true)
      : limits(c.limits),
        shape(c.virtual_dynamics()),
        dead_band(c.tolerance_of_lag()),
        max_lead(c.largest_lead()),
        resting_speed(c.resting_speed()),
        period(c.period),
        delay(c.delay),
        substep(c.substep),
        longest_interval(c.longest()),
        cycle(seconds<T>(c.period)),
        torque_rate(c.torque_rate),
        largest_gap(c.largest_gap),
        lag(seconds<T>(c.lag)),
        retry(seconds<T>(c.retry)),
        lag_of_robot_(c.lag),
        lead_of_robot_(c.max_lead) {
    check(c, has_virtual_robot);
    total_delay = seconds<T>(c.total_delay());
    per_delay = T(1) / total_delay;
    settle = T(10) * total_delay;
    forgets = settle / (settle + seconds<T>(c.period));
    fresh_for = c.total_delay() + period / 2;
    stale_after = c.stale();
    const T w = c.observer.value_or(T(0.3) / total_delay);
    L1 = T(2) * w;
    L2 = w * w;
    catch_up = T(0.25) / seconds<T>(period);
    drift = c.drift.value_or(w < T(0.2) ? w : T(0.2));
    for (std::size_t i = 0; i < N; ++i) {
      has_coulomb = has_coulomb || shape.coulomb[i] > T(0);
    }
  }

  /// The part of the robot's configuration that a guard reads.
  [[nodiscard]] RobotConfiguration<N, T> for_guard() const {
    return {.limits = limits,
            .period = period,
            .delay = delay,
            .lag = lag_of_robot_,
            .dead_band = dead_band,
            .max_lead = lead_of_robot_,
            .longest_interval = longest_interval,
            .stale_after = stale_after};
  }

 private:
  Nanoseconds lag_of_robot_;
  T lead_of_robot_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
