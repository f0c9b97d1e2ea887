// The configuration of a robot: all numbers that describe it besides its model, each stated once.
#pragma once

#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Limits, timing and virtual dynamics of a robot's joints. Resolver, guard, limits and laws derive their
/// settings from it; `check` is called when a description is built from it.
template <std::size_t N, Real T = double>
struct RobotConfiguration {
  JointLimits<N, T> limits;
  /// Planned time between two cycles, 0.1 ms to 1 s.
  Nanoseconds period;
  /// T_d: from sending a command until the robot begins to move, plus the age of a measurement when it is
  /// stamped.
  Nanoseconds delay{};
  /// tau: time constant of the robot's own control loop.
  Nanoseconds lag{};
  /// Stiffness of the springs by which the robot's own controller holds its joints [N m/rad], > 0. For robots by
  /// impedance, which need it, and for no others.
  std::optional<JointTorque<N, T>> stiffness = {};
  /// Time constant with which these springs give way to a push: damping over stiffness of a joint that carries much,
  /// 2 damping ratio sqrt(inertia/stiffness). Default: `lag`.
  std::optional<Nanoseconds> spring_lag = {};
  /// Friction of the virtual robot in proportion to its mass, `B = virtual_damping M` [1/s]: free motion dies out as
  /// `exp(-virtual_damping t)`. Without a default: with 0 and no other friction an arm glides on after a touch. 0, or
  /// left out, for a robot by torque.
  std::optional<T> virtual_damping = {};
  /// Viscous friction per joint [N m s/rad]: of the virtual robot, or added to the real friction of a robot
  /// by torque.
  JointTorque<N, T> viscous_friction = {};
  JointTorque<N, T> coulomb_friction = {};  ///< of the virtual robot, per joint [N m]
  /// Added to each joint [kg m^2]: of the virtual robot, or by torque that of the real motors behind their gears.
  JointTorque<N, T> virtual_inertia = {};
  /// r_tol: dead band of the difference [rad] between measured and expected position, inside of which the
  /// robot counts as following. It covers the parts of lag and gap that are not declared: three times the
  /// encoder's standard deviation, the top speed times the uncertainty of the delay, the droop of the servo.
  /// Default: a third of e_max (see `max_lead`), 50 mrad for an arm of 3 rad/s with T = 24 ms.
  std::optional<JointPosition<N, T>> dead_band = {};
  /// w [1/s]: gain of the observer, at most 0.3/T with T = delay + lag + period; that is the default.
  std::optional<T> observer = {};
  /// Time by which a law gets a touch ahead, see `TouchChange`: 0 to 2 T; 0 for none. Default: the delay of a
  /// contact's loop, delay + lag + 1.5 periods: one until a measurement shows the motion, half of one that a command
  /// is held. More damps stiff walls better, and the grip of light hands less well.
  std::optional<Nanoseconds> force_lead = {};
  /// Velocity interface only: rate at which the virtual robot's position converges to the measured one
  /// without moving the robot [1/s], at most w. A joint that stands still while it is sent less than drift times dead band is not noticed.
  /// Default: 0.2, or w if that is less.
  std::optional<T> drift = {};
  /// e_max in units of v_max T: the greatest distance of the virtual robot ahead of the measured one. Less
  /// than `1 + v_max/(2 a T)` lowers the top speed, see `Resolver::top_speed`.
  T max_lead = T(2);
  /// Longest sub-step; up to `max_substeps` of equal length make an interval.
  Nanoseconds substep = 2ms;
  /// Longest interval that is integrated at once; the remainder of a longer one is dropped. Default: five
  /// periods. The velocity interface keeps a distance for this time at the present speed before every
  /// position limit.
  std::optional<Nanoseconds> longest_interval = {};
  /// Age of the last good measurement at which the robot brakes: resolver and guard alike. Default: 5 T.
  std::optional<Nanoseconds> stale_after = {};
  /// Time after which a blocked robot that is still pushed the same way tries again.
  Nanoseconds retry = 1s;
  /// The largest rate of the torque that laws ask for by themselves, in torque limits per second; torques that
  /// answer touch are not delayed.
  T torque_rate = T(50);
  /// The largest gap between commands and measurements [rad] to which a user can agree, and from which a scene can
  /// start; 0 to 0.5. A displaced robot with a larger one holds until it has been mended.
  T largest_gap = T(0.15);

  /// The virtual inertia, damping and friction together.
  [[nodiscard]] VirtualDynamics<N, T> virtual_dynamics() const noexcept {
    return {viscous_friction, coulomb_friction, virtual_inertia, virtual_damping.value_or(T(0))};
  }
  void set(const VirtualDynamics<N, T>& d) noexcept {
    viscous_friction = d.viscous;
    coulomb_friction = d.coulomb;
    virtual_inertia = d.inertia;
    virtual_damping = d.damping;
  }
  /// T = delay + lag + period: the time until a command shows in a measurement.
  [[nodiscard]] constexpr Nanoseconds total_delay() const noexcept { return delay + lag + period; }
  /// `force_lead`, or its default.
  [[nodiscard]] constexpr Nanoseconds leads_force_by() const noexcept {
    return force_lead.value_or(delay + lag + 3 * period / 2);
  }
  [[nodiscard]] constexpr Nanoseconds longest() const noexcept {
    return longest_interval.value_or(5 * period);
  }
  /// After how long without a state the robot brakes: `stale_after`, or five times T, 10 s at most.
  [[nodiscard]] constexpr Nanoseconds stale() const noexcept {
    const Nanoseconds usual = 5 * total_delay();
    return stale_after.value_or(usual < Nanoseconds(10s) ? usual : Nanoseconds(10s));
  }
  /// e_max [rad].
  [[nodiscard]] JointPosition<N, T> largest_lead() const noexcept {
    JointPosition<N, T> e;
    for (std::size_t i = 0; i < N; ++i) e[i] = max_lead * limits.velocity()[i] * seconds<T>(total_delay());
    return e;
  }
  /// r_tol [rad].
  [[nodiscard]] JointPosition<N, T> tolerance_of_lag() const noexcept {
    return dead_band ? *dead_band : T(1) / T(3) * largest_lead();
  }
  /// Largest distance of a command from the measured position [rad] that following, lag and obstacles explain: e_max,
  /// and r_tol, within which a difference does not count.
  [[nodiscard]] JointPosition<N, T> largest_distance() const noexcept {
    return largest_lead() + tolerance_of_lag();
  }
  /// Speed of a joint that starts as if at rest [rad/s]: in T it covers a fifth of r_tol.
  [[nodiscard]] JointVelocity<N, T> resting_speed() const noexcept {
    const JointPosition<N, T> band = tolerance_of_lag();
    JointVelocity<N, T> u;
    for (std::size_t i = 0; i < N; ++i) u[i] = T(0.2) * band[i] / seconds<T>(total_delay());
    return u;
  }
};

/// Maximum number of sub-steps of one interval.
inline constexpr unsigned max_substeps = 16;

/// The length of a sub-step in a cycle on time; all of the period where `substep` is not positive.
[[nodiscard]] constexpr Nanoseconds planned_substep(Nanoseconds period, Nanoseconds substep) noexcept {
  if (substep <= 0ns || substep >= period) return period;
  const auto steps = (period - 1ns) / substep + 1;
  return period / (steps < max_substeps ? steps : std::int64_t(max_substeps));
}

/// Throws `ConfigurationError` for a configuration with springs, of joints that have none.
template <std::size_t N, Real T>
SKINCTL_COLD void refuse_springs(const RobotConfiguration<N, T>& c) {
  constexpr const char* none = "left out: only joints by impedance have springs";
  require(!c.stiffness, "stiffness", static_cast<double>(c.stiffness ? (*c.stiffness)[0] : T(0)), none);
  require(!c.spring_lag, "spring lag", milliseconds(c.spring_lag.value_or(0ns)), none);
}

/// Throws `ConfigurationError` with number and range for an invalid configuration. The observer's numbers are
/// not read for a robot by torque, which has no virtual robot.
template <std::size_t N, Real T>
SKINCTL_COLD void check(const RobotConfiguration<N, T>& c, bool has_virtual_robot = true) {
  const auto number = [](const T& x) { return static_cast<double>(x); };
  const auto ms = [](Nanoseconds t) { return milliseconds(t); };
  require(c.period >= 100us && c.period <= 1s, "period", ms(c.period), "0.1 to 1000 ms");
  require(c.delay >= 0ns && c.delay <= 1s, "delay", ms(c.delay), "0 to 1000 ms");
  require(c.lag >= 0ns && c.lag <= 1s, "lag", ms(c.lag), "0 to 1000 ms");
  const Nanoseconds gives = c.spring_lag.value_or(c.lag);
  require(gives >= 0ns && gives <= 1s, "spring lag", ms(gives), "0 to 1000 ms");
  require(c.substep >= 10us && c.substep <= 20ms, "sub-step", ms(c.substep), "0.01 to 20 ms");
  const Nanoseconds total = c.total_delay();
  const T most = T(0.3) / seconds<T>(total), w = c.observer.value_or(most);
  require(w > T(0) && w <= most * (T(1) + tolerance<T>), "observer w", number(w),
          "> 0, <= 0.3/(delay + lag + period) 1/s");
  require(c.leads_force_by() >= 0ns && c.leads_force_by() <= 2 * total, "force lead", ms(c.leads_force_by()),
          ">= 0, <= 2 (delay + lag + period), in ms");
  const T drift = c.drift.value_or(w < T(0.2) ? w : T(0.2));
  require(drift >= T(0) && drift <= w, "drift", number(drift), ">= 0, <= w 1/s");
  require(c.max_lead >= T(1.2) && c.max_lead <= T(100), "max_lead", number(c.max_lead), "1.2 to 100 v_max T");
  require(c.torque_rate > T(0) && c.torque_rate <= T(1e6), "torque rate", number(c.torque_rate),
          "> 0, <= 1e6 torque limits per second");
  require(c.largest_gap >= T(0) && c.largest_gap <= T(0.5), "largest gap", number(c.largest_gap),
          "0 to 0.5 rad");
  require(c.retry > 0ns && c.retry <= 3600s, "retry", seconds<double>(c.retry), "> 0, <= 3600 s");
  require(c.longest() >= c.period && c.longest() <= 1s + 10 * c.period, "longest interval", ms(c.longest()),
          ">= period, <= 1 s + 10 periods, in ms");
  require(c.stale() >= c.period && c.stale() <= 10s, "stale after", ms(c.stale()), ">= period, <= 10 000 ms");
  if (!has_virtual_robot) refuse_springs(c);
  if (has_virtual_robot && !c.virtual_damping)
    refuse("skinctl: virtual damping: left out, allowed: 0 to 1e4 1/s; 4 to 10 is usual");
  const T damping = c.virtual_damping.value_or(T(0));
  require(damping >= T(0) && damping <= T(1e4), "virtual damping", number(damping), "0 to 1e4 1/s");
  const JointPosition<N, T> band = c.tolerance_of_lag(), lead = c.largest_lead();
  for (std::size_t i = 0; i < N; ++i) {
    const T lower = c.limits.lower()[i], upper = c.limits.upper()[i],
            inf = std::numeric_limits<T>::infinity();
    require(lower >= T(-60) || lower == -inf, "lower position limit", number(lower),
            ">= -60 rad or m, or -infinity: are these degrees?");
    require(upper <= T(60) || upper == inf, "upper position limit", number(upper),
            "<= 60 rad or m, or infinity: are these degrees?");
    require(!c.dead_band || (band[i] > T(0) && band[i] <= T(1)), "dead band", number(band[i]),
            "> 0, <= 1 rad");
    require(!c.stiffness || ((*c.stiffness)[i] > T(0) && (*c.stiffness)[i] <= T(1e6)), "stiffness",
            number(c.stiffness ? (*c.stiffness)[i] : T(0)), "> 0, <= 1e6 N m/rad");
    require(c.viscous_friction[i] >= T(0) && c.viscous_friction[i] <= T(1e6), "viscous friction",
            number(c.viscous_friction[i]), "0 to 1e6 N m s/rad");
    require(c.coulomb_friction[i] >= T(0) && c.coulomb_friction[i] <= T(1e6), "Coulomb friction",
            number(c.coulomb_friction[i]), "0 to 1e6 N m");
    require(c.virtual_inertia[i] >= T(0) && c.virtual_inertia[i] <= T(1e6), "virtual inertia",
            number(c.virtual_inertia[i]), "0 to 1e6 kg m^2");
    require(!has_virtual_robot || lead[i] > band[i], "dead band", number(band[i]),
            "below max_lead v_max T: a blocked robot must be noticed");
  }
}

SKINCTL_END_NAMESPACE
