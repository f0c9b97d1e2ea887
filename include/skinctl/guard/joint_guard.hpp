// SPDX-License-Identifier: BSD-3-Clause
// The guard of joints that have one interface.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/measurement.hpp"
#include "skinctl/guard/detail/reach.hpp"
#include "skinctl/guard/faults.hpp"
#include "skinctl/guard/guard_settings.hpp"
#include "skinctl/robot/robot_configuration.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The guard of joints with one interface. A command passes unchanged if it is finite, if the robot's state
/// is fresh, if no stage found a fault, and if a motion from the last command to it exists within the
/// limits of acceleration and velocity, after which the joint can still stop before its end. Otherwise the
/// guard reacts in the same cycle, as the table `faults` says: it brakes with the acceleration limit and
/// holds; torques are cut, or ramp to the fallback. A torque beside positions keeps its limits and its
/// rate, and ramps to zero while it brakes.
///
/// With `Smooth` the guard brakes as it says, such as `JerkLimits`: a motion that can be stopped within its
/// jerk keeps it (a governor with the same limits sends no other); for others the limits give way as that
/// class documents (`jerk_exceeded`). Whether a command keeps its jerk is left to the governor: the guard
/// checks acceleration, velocity and position.
///
/// Most reactions end by themselves, once the given command can be reached within the limits; the resolver
/// goes on from the command that was sent. After a `stop` the guard waits for `acknowledge`
/// (`consent_awaited`). It never steps and never gives a number that is not finite, whatever the input.
///
/// A start is not believed: no command is valid before the first good and fresh state of the robot, which
/// decides. The start is refused (`start_refused`), and no command is valid until a guard is started again,
/// if a joint
///
/// - is further than `GuardSettings::lead` from where it was started, or than the dead band if that is beyond
///   a position limit;
/// - has another speed than that of the start, by more than the acceleration limit changes it in
///   delay + lag + period, and `RobotConfiguration::resting_speed`.
template <Interface Ix, std::size_t N, Real T = double, class Smooth = Abrupt>
class JointGuard : public detail::GuardReach<Ix, N, T> {
  using Reach = detail::GuardReach<Ix, N, T>;

 public:
  static constexpr bool smooth = !std::is_same_v<Smooth, Abrupt>;
  static_assert(!smooth || Ix != Interface::torque,
                "a torque interface has no motion whose jerk could be limited: leave JerkLimits out");
  static constexpr Interface interface = Ix;
  static constexpr std::size_t joints = N;
  using scalar = T;
  using Settings = GuardSettings<N, T>;
  using Memory = GuardMemory<N, T>;
  /// Whether commands hold a torque beside positions, as by impedance.
  static constexpr bool beside_motion = takes_position(Ix) && takes_torque(Ix);

  /// Throws `ConfigurationError` for a number out of its range.
  ///
  /// @param robot    limits, period, longest interval and `stale_after` are read.
  /// @param braking  the same limits of the joints with limits of jerk, if the guard has them.
  explicit JointGuard(const RobotConfiguration<N, T>& robot, const Settings& c = {},
                      const Smooth& braking = Smooth())
      : Reach(robot.limits, robot.period, robot.longest()),
        stale_after_(robot.stale()),
        settings_(c),
        start_distance_(c.lead.value_or(robot.largest_distance())),
        dead_band_(robot.dead_band),
        speed_change_(
            integrate(robot.resting_speed(), robot.limits.acceleration(), seconds<T>(robot.total_delay()))),
        torque_rate_(c.torque_rate),
        beyond_(c.beyond),
        overspeed_(c.overspeed),
        acts_on_(c.brakes_on | detail::guard_brakes_on),
        consent_(c.consent | detail::guard_waits_after),
        braking_(braking) {
    lead_ =
        c.lead ? start_distance_ : start_distance_ + Distance(limits_.stopping_distance(limits_.velocity()));
    const auto number = [](const auto& x) { return static_cast<double>(x); };
    require(period_ >= 100us && period_ <= 1s, "period", milliseconds(period_), "0.1 to 1000 ms");
    require(longest_ >= period_ && longest_ <= 10s, "longest interval", milliseconds(longest_),
            ">= period, <= 10 000 ms");
    require(stale_after_ >= period_ && stale_after_ <= 10s, "stale after", milliseconds(stale_after_),
            ">= period, <= 10 000 ms");
    require(torque_rate_ > T(0) && torque_rate_ <= T(1e6), "torque rate", number(torque_rate_),
            "> 0, <= 1e6 1/s");
    require(beyond_ >= T(0), "beyond", number(beyond_), ">= 0 rad");
    require(overspeed_ >= T(1), "overspeed", number(overspeed_), ">= 1");
    for (std::size_t i = 0; i < N; ++i) require(lead_[i] > T(0), "lead", number(lead_[i]), "> 0 rad");
  }

  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  /// Takes over a robot with the command `command` in the state `measured`. For a command that is not valid
  /// or not plausible, or a state that this robot cannot have, nothing passes until a guard is started with
  /// good ones.
  [[nodiscard]] SKINCTL_COLD Memory start(const JointCommand<N, T>& command,
                                          const State<N, T>& measured) const noexcept {
    Memory m;
    m.command = command;
    m.command.valid = command.valid && detail::is_plausible(command) && detail::is_plausible(measured) &&
                      believes(measured) && detail::is_plausible(command.time) &&
                      detail::is_plausible(measured.time);
    return m;
  }

  /// The command that may leave at the end of the interval of this cycle.
  ///
  /// @param interval  of the robot's clock, as its resolver judges it.
  /// @param measured  the last good state of the robot, as its resolver keeps it, or `take_measurement`.
  /// @param fallback  torque interface: the torque without a valid one, such as gravity compensation with
  ///                  damping. Not finite: zero.
  /// @param found     reasons of other stages in this cycle, and of the loop before it.
  SKINCTL_INLINE Guarded<N, T> step(Memory& m, const JointCommand<N, T>& wish, const State<N, T>& measured,
                                    const Interval& interval, const JointTorque<N, T>& fallback = {},
                                    Status found = {}) const noexcept {
    m.latched |= found & consent_;
    if (!m.begun) [[unlikely]]
      if (const auto refused = begin(m, measured, interval.seen, found); !m.begun) return refused;
    SKINCTL_EXPECTS(detail::is_plausible(measured), "the last good state: see take_measurement");
    Status status;
    status |= interval.status;
    if (status.has(Reason::interval_empty)) [[unlikely]] {
      if (m.latched.any()) status |= Reason::consent_awaited;
      return {m.command, status, !(wish.time == interval.to)};
    }
    Nanoseconds elapsed = period_;
    if (!status.has(Reason::time_backwards)) [[likely]] {
      // A clock that was just set vouches for no more than a period.
      elapsed = interval.clock_set ? period_ : interval.to - interval.from;
      if (interval.to - measured.time > stale_after_) status |= Reason::state_stale;
    }
    const bool good = !status.has(Reason::time_backwards) && !status.has(Reason::state_stale) &&
                      !(found & acts_on_).any() && !((status & consent_) | m.latched).any();
    const bool finite = wish.valid && detail::is_plausible(wish);
    if (!finite) status |= Reason::command_not_finite;
    const T dt = seconds<T>(elapsed);
    if constexpr (Ix == Interface::torque) {
      return let_out(m, interval.to, turn_torque(m, wish, measured, good && finite, fallback, dt, status));
    } else {
      const T given =
          seconds<T>(status.has(Reason::time_backwards) ? period_ : interval.command_duration(period_));
      if (good && finite && wish.time == interval.to &&
          this->can_reach(m.command, wish, measured, given, status)) [[likely]] {
        if constexpr (beside_motion) {
          const Row beside = m.command.torque;
          m.command = wish;
          status |= turn_beside(beside, wish.torque, measured, dt, m.command.torque);
          return {m.command, status, false};
        }
        m.command = wish;
        return {wish, status, false};
      }
      Guarded<N, T> out = brake(m, measured, given, status);
      if constexpr (beside_motion)
        out.status |= turn_beside(m.command.torque, {}, measured, dt, out.command.torque);
      out.brakes = !good;
      return let_out(m, interval.to, out);
    }
  }

  /// Takes the user's consent: latched faults end, unless they are still present.
  void acknowledge(Memory& m) const noexcept { m.latched = {}; }
  /// Whether the robot waits for the user's consent.
  [[nodiscard]] static bool waits(const Memory& m) noexcept { return m.latched.any(); }
  /// Whether nothing passes until a guard is started anew.
  [[nodiscard]] static bool refuses_start(const Memory& m) noexcept { return !m.command.valid; }

  /// Whether this robot can be in the state `s`: within `beyond` of its ends, below `overspeed`. NaN:
  /// false.
  [[nodiscard]] SKINCTL_INLINE bool believes(const State<N, T>& s) const noexcept {
    using R = detail::Row<N, T>;
    const R q = s.q, dq = s.dq, fast = overspeed_ * R(limits_.velocity());
    const auto can = (q >= R(limits_.lower()) - beyond_) & (q <= R(limits_.upper()) + beyond_) &
                     (dq >= -fast) & (dq <= fast);
    return !any(!can);
  }

 private:
  using Reach::lead_;
  using Reach::limits_;
  using Reach::longest_;
  using Reach::period_;
  using Size = std::size_t;
  using Row = detail::Row<N, T>;
  using Distance = JointPosition<N, T>;
  // The first good state of the robot decides whether it stands where it was started.
  SKINCTL_COLD Guarded<N, T> begin(Memory& m, const State<N, T>& measured, Nanoseconds now,
                                   Status found) const noexcept {
    Guarded<N, T> out{m.command, {}, true};
    out.command.valid = false;
    if (!detail::is_plausible(now)) {
      out.status = Reason::time_backwards;
    } else if (now - measured.time > stale_after_) {
      out.status = Reason::state_stale;
    }
    if (!((found | out.status) & detail::no_new_state).any())
      m.command.valid = m.begun = m.command.valid && stands_at(m.command, measured);
    if (!m.command.valid) out.status |= Reason::start_refused;
    m.latched |= out.status & consent_;
    if (m.latched.any()) out.status |= Reason::consent_awaited;
    return out;
  }
  SKINCTL_COLD bool stands_at(const JointCommand<N, T>& start, const State<N, T>& measured) const noexcept {
    using R = detail::Row<N, T>;
    const R at = start.position, u = start.velocity, q = measured.q, dq = measured.dq, far = start_distance_;
    const R next = at + R(seconds<T>(period_)) * u;  // the first command is between
    const auto outside = (at > R(limits_.upper())) | (at < R(limits_.lower()));
    const R most = select(outside, smaller(far, R(dead_band_)), far);
    return all((magnitude(at - q) <= most) & (magnitude(next - q) <= most) &
               (magnitude(u - dq) <= R(speed_change_)));
  }
  SKINCTL_INLINE Guarded<N, T> let_out(Memory& m, Nanoseconds at, Guarded<N, T> out) const noexcept {
    m.latched |= out.status & consent_;
    if (m.latched.any()) [[unlikely]]
      out.status |= Reason::consent_awaited;
    out.command.time = at;
    out.command.valid = true;
    m.command = out.command;
    return out;
  }

  SKINCTL_COLD Guarded<N, T> brake(const Memory& m, const State<N, T>& measured, const T& dt,
                                   Status status) const noexcept {
    Guarded<N, T> out{m.command, status, true};
    const auto& last = m.command;
    if constexpr (smooth) {
      const auto motion =
          braking_.brake(this->room(measured, last.position), last.velocity, last.acceleration, dt);
      out.status |= motion.status & Status(Reason::jerk_exceeded);
      for (Size i = 0; i < N; ++i) {
        const T q = last.position[i], to = q + motion.displacement[i];
        const bool passed = (to > limits_.upper()[i] && q <= limits_.upper()[i]) ||
                            (to < limits_.lower()[i] && q >= limits_.lower()[i]);
        out.command.position[i] =
            passed ? detail::clamp(to, limits_.lower()[i], limits_.upper()[i]) : to;  // rounding
      }
      out.command.velocity = motion.velocity;
      out.command.acceleration = motion.acceleration;
      return out;
    }
    const auto motion =
        limits_.move(this->room(measured, last.position), last.velocity, JointVelocity<N, T>{}, dt);
    for (Size i = 0; i < N; ++i) {
      out.command.position[i] = last.position[i] + motion.displacement[i];
      out.command.velocity[i] = motion.velocity[i];
      out.command.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
    }
    return out;
  }

  /// Turns the torque beside a motion, into `out`: from the last one towards `wish`, within its limits, at
  /// most at the allowed rate.
  SKINCTL_INLINE Status turn_beside(const Row& last, const JointTorque<N, T>& wish,
                                    const State<N, T>& measured, const T& dt,
                                    JointTorque<N, T>& out) const noexcept {
    const Row step = T(torque_rate_ * dt) * Row(limits_.torque()), wanted = wish;
    const Row given = clamp(Row(limits_.within(wish, measured.dq)), last - step, last + step);
    given.store(out);
    return any(given != wanted) ? Status(Reason::torque_limited) : Status();
  }
  /// Turns the torque towards the given one or the fallback, at most at the allowed rate.
  SKINCTL_INLINE Guarded<N, T> turn_torque(const Memory& m, const JointCommand<N, T>& wish,
                                           const State<N, T>& measured, bool good,
                                           const JointTorque<N, T>& fallback, const T& dt,
                                           Status status) const noexcept {
    using R = detail::Row<N, T>;
    const R step = T(torque_rate_ * dt) * R(limits_.torque()), last = m.command.torque;
    const JointTorque<N, T> rest = detail::is_finite(fallback) ? fallback : JointTorque<N, T>();
    const JointTorque<N, T>& asked = good ? wish.torque : rest;
    const R wanted = asked, within = limits_.within(asked, measured.dq);
    const R given = clamp(within, last - step, last + step);
    const bool limited = good && any(within != wanted), slowed = any(given != within);
    if (limited) status |= Reason::torque_limited;
    if (slowed) status |= Reason::step_limited;
    Guarded<N, T> out{good ? wish : m.command, status, !good || limited || slowed, !good};
    given.store(out.command.torque);
    return out;
  }

  Nanoseconds stale_after_;
  Settings settings_;
  Distance start_distance_, dead_band_;
  JointVelocity<N, T> speed_change_;  ///< largest change of speed from the start to the first state [rad/s]
  T torque_rate_, beyond_, overspeed_;
  Status acts_on_;  ///< reasons of other stages on which it brakes
  Status consent_;  ///< reasons that wait for `acknowledge`
  [[no_unique_address]] Smooth braking_;
};

SKINCTL_END_NAMESPACE
