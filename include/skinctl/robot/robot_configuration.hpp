// SPDX-License-Identifier: BSD-3-Clause
// The configuration of a robot: all numbers that describe it besides its model, each stated once.
#pragma once

#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Total delays after which a transient of the loop is over: e^-5, 0.7 %, is left of a first-order lag.
inline constexpr int settled_delays = 5;
/// Gain of a loop times its delay, where nothing else is asked for: without overshoot up to 1/e, 0.37.
inline constexpr double gain_times_delay = 0.3;
/// Largest motion of a joint that counts as at rest, over its dead band, which is five times the noise or
/// more.
inline constexpr double resting_share = 0.2;
}  // namespace detail

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
  /// Stiffness of the springs by which the robot's own controller holds its joints [N m/rad], > 0. For robots
  /// by impedance, which need it, and for no others.
  std::optional<JointTorque<N, T>> stiffness = {};
  /// Time constant with which these springs give way to a push: damping over stiffness of a joint that
  /// carries much, 2 damping ratio sqrt(inertia/stiffness). Default: `lag`.
  std::optional<Nanoseconds> spring_lag = {};
  /// Friction of the virtual robot in proportion to its mass, `B = virtual_damping M` [1/s]: free motion dies
  /// out as `exp(-virtual_damping t)`. Without a default: with 0 and no other friction an arm glides on after
  /// a touch. 0, or left out, for a robot by torque.
  std::optional<T> virtual_damping = {};
  /// Viscous friction per joint [N m s/rad]: of the virtual robot, or added to the real friction of a robot
  /// by torque.
  JointTorque<N, T> viscous_friction = {};
  JointTorque<N, T> coulomb_friction = {};  ///< Coulomb friction of the virtual robot, per joint [N m]
  /// Inertia added to each joint [kg m^2]: of the virtual robot, or by torque that of the real motors behind
  /// their gears.
  JointTorque<N, T> virtual_inertia = {};
  /// B0: distance [rad] by which a command may be from a robot at rest, > 0, <= 1. It holds the friction of
  /// the servo, the gap of encoders that are off, and noise. Friction that needs more holds the joint for
  /// good; what a robot that was held fast leaps by when it is let go is as large.
  JointPosition<N, T> dead_band = JointPosition<N, T>::constant(T(0.02));
  /// t_u: lag beyond the declared one that is borne, 0 to 1 s. A robot that is later than that is slowed.
  Nanoseconds undeclared_lag = 50ms;
  /// Time by which a law gets a touch ahead, see `TouchChange`: 0 to 2 (delay + lag + period); 0 for none.
  /// Default: the delay of a contact's loop, delay + lag + 1.5 periods: one until a measurement shows the
  /// motion, half of one that a command is held. More damps stiff walls better, and the grip of light hands
  /// less well.
  std::optional<Nanoseconds> force_lead = {};
  /// Velocity interface only: rate at which the virtual robot's position converges to the measured one
  /// without moving the robot [1/s], 0 to 0.3/(delay + lag + period). A joint that is held is pushed with
  /// this rate times its dead band. Default: 0.2, or the largest if that is less.
  std::optional<T> drift = {};
  /// Longest sub-step; up to `max_substeps` of equal length make an interval.
  Nanoseconds substep = 2ms;
  /// Longest interval that is integrated at once; the remainder of a longer one is dropped. Default: five
  /// periods. The velocity interface keeps a distance for this time at the present speed before every
  /// position limit.
  std::optional<Nanoseconds> longest_interval = {};
  /// Age of the last good measurement at which the robot brakes: resolver and guard alike. Default:
  /// 5 (delay + lag + period), at most 10 s.
  std::optional<Nanoseconds> stale_after = {};
  /// The largest rate of the torque that laws ask for by themselves, in torque limits per second; torques
  /// that answer touch are not delayed.
  T torque_rate = T(50);
  /// The largest gap between commands and measurements [rad] that is borne, and from which a scene can start;
  /// 0 to 0.5. A robot with a larger one is displaced: it holds until it has been mended.
  T largest_gap = T(0.15);

  /// The virtual inertia, damping and friction together; 0 for a damping that is left out.
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
  /// Age of the last good measurement at which the robot brakes: `stale_after`, or five times
  /// `total_delay()`, 10 s at most.
  [[nodiscard]] constexpr Nanoseconds stale() const noexcept {
    const Nanoseconds usual = detail::settled_delays * total_delay();
    return stale_after.value_or(usual < Nanoseconds(10s) ? usual : Nanoseconds(10s));
  }
  /// Time by which a robot may be behind its commands: `total_delay()` and the undeclared lag that is borne.
  [[nodiscard]] constexpr Nanoseconds latest() const noexcept { return total_delay() + undeclared_lag; }
  /// Distance [rad] by which a command that starts or stops at its acceleration limit A is ahead of a robot
  /// whose speed does not show it yet: `A d (tau + d/2)` with d = delay + period and the lag tau.
  [[nodiscard]] JointPosition<N, T> owed_by_acceleration() const noexcept {
    const T d = seconds<T>(delay + period);
    return T(d * (seconds<T>(lag) + T(0.5) * d)) *
           JointPosition<N, T>(detail::Row<N, T>(limits.acceleration()));
  }
  /// The largest distance of a command from the measured position [rad]: that of a robot at full speed.
  [[nodiscard]] JointPosition<N, T> largest_distance() const noexcept {
    JointPosition<N, T> e = owed_by_acceleration();
    for (std::size_t i = 0; i < N; ++i) e[i] += dead_band[i] + limits.velocity()[i] * seconds<T>(latest());
    return e;
  }
  /// Speed of a joint that counts as at rest [rad/s]: it leads the leash by a fifth of the dead band.
  [[nodiscard]] JointVelocity<N, T> resting_speed() const noexcept {
    JointVelocity<N, T> u;
    for (std::size_t i = 0; i < N; ++i) u[i] = T(detail::resting_share) * dead_band[i] / seconds<T>(latest());
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

/// Throws `ConfigurationError` with number and range for an invalid configuration. A robot by torque, without
/// a virtual robot, may leave out the virtual damping, and has no springs.
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
  require(c.undeclared_lag >= 0ns && c.undeclared_lag <= 1s, "undeclared lag", ms(c.undeclared_lag),
          "0 to 1000 ms");
  require(c.leads_force_by() >= 0ns && c.leads_force_by() <= 2 * total, "force lead", ms(c.leads_force_by()),
          ">= 0, <= 2 (delay + lag + period), in ms");
  const T drift = c.drift.value_or(T(0)), fastest = T(detail::gain_times_delay) / seconds<T>(total);
  require(drift >= T(0) && drift <= fastest * (T(1) + tolerance<T>), "drift", number(drift),
          ">= 0, <= 0.3/(delay + lag + period) 1/s");
  require(c.torque_rate > T(0) && c.torque_rate <= T(1e6), "torque rate", number(c.torque_rate),
          "> 0, <= 1e6 torque limits per second");
  require(c.largest_gap >= T(0) && c.largest_gap <= T(0.5), "largest gap", number(c.largest_gap),
          "0 to 0.5 rad");
  require(c.longest() >= c.period && c.longest() <= 1s + 10 * c.period, "longest interval", ms(c.longest()),
          ">= period, <= 1 s + 10 periods, in ms");
  require(c.stale() >= c.period && c.stale() <= 10s, "stale after", ms(c.stale()), ">= period, <= 10 000 ms");
  if (!has_virtual_robot) refuse_springs(c);
  if (has_virtual_robot && !c.virtual_damping)
    refuse("skinctl: virtual damping: left out, allowed: 0 to 1e4 1/s; 4 to 10 is usual");
  const T damping = c.virtual_damping.value_or(T(0));
  require(damping >= T(0) && damping <= T(1e4), "virtual damping", number(damping), "0 to 1e4 1/s");
  for (std::size_t i = 0; i < N; ++i) {
    const T lower = c.limits.lower()[i], upper = c.limits.upper()[i],
            inf = std::numeric_limits<T>::infinity();
    require(lower >= T(-60) || lower == -inf, "lower position limit", number(lower),
            ">= -60 rad or m, or -infinity: are these degrees?");
    require(upper <= T(60) || upper == inf, "upper position limit", number(upper),
            "<= 60 rad or m, or infinity: are these degrees?");
    require(c.dead_band[i] > T(0) && c.dead_band[i] <= T(1), "dead band", number(c.dead_band[i]),
            "> 0, <= 1 rad");
    require(!c.stiffness || ((*c.stiffness)[i] > T(0) && (*c.stiffness)[i] <= T(1e6)), "stiffness",
            number(c.stiffness ? (*c.stiffness)[i] : T(0)), "> 0, <= 1e6 N m/rad");
    require(c.viscous_friction[i] >= T(0) && c.viscous_friction[i] <= T(1e6), "viscous friction",
            number(c.viscous_friction[i]), "0 to 1e6 N m s/rad");
    require(c.coulomb_friction[i] >= T(0) && c.coulomb_friction[i] <= T(1e6), "Coulomb friction",
            number(c.coulomb_friction[i]), "0 to 1e6 N m");
    require(c.virtual_inertia[i] >= T(0) && c.virtual_inertia[i] <= T(1e6), "virtual inertia",
            number(c.virtual_inertia[i]), "0 to 1e6 kg m^2");
  }
}

SKINCTL_END_NAMESPACE
