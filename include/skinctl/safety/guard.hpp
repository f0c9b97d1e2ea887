// The guard: the last word before a command leaves.
#pragma once

#include <optional>

#include "skinctl/core/state.hpp"
#include "skinctl/safety/command.hpp"
#include "skinctl/safety/detail/plausible.hpp"
#include "skinctl/safety/limits.hpp"

SKINCTL_BEGIN_NAMESPACE

template <std::size_t N, Real T = double>
struct GuardConfiguration {
  JointLimits<N, T> limits;
  /// Time between two cycles as planned [ns].
  Nanoseconds period;
  /// Longest time that a motion may take credit for [ns]; default: five periods. As in the resolver.
  std::optional<Nanoseconds> longest_interval = {};
  /// Age of the robot's newest state from which on the command brakes [ns]; default: 25 periods.
  std::optional<Nanoseconds> stale_after = {};
  /// Position interface: how far a command may be from the measured position [rad].
  JointPosition<N, T> lead = JointPosition<N, T>::constant(std::numeric_limits<T>::infinity());
  /// Torque interface: fastest change of a torque, in units of the torque limit per second; also how fast the
  /// fallback takes over.
  T torque_rate = T(50);
};

/// What a guard remembers: the last command it let out. Trivially copyable.
template <std::size_t N, Real T = double>
struct GuardMemory {
  Nanoseconds time = 0;
  State<N, T> measured;  ///< the newest good state
  JointCommand<N, T> command;
};

/// What the guard lets out; `altered` says that it is not what was asked for (tell the resolver, see
/// `Resolver::sent`).
template <std::size_t N, Real T = double>
struct Guarded {
  JointCommand<N, T> command;
  Status status;
  bool altered = false;
};

/// Lets a command pass unchanged if it is finite, if the robot's state is fresh, and if there is a motion
/// from the last command to it within the limits of acceleration and velocity, after which the joint can
/// still stop before its end. Else, in the same cycle:
///
/// | interface | reaction | way back |
/// |---|---|---|
/// | position, velocity | brakes with the acceleration limit and holds | by itself, once the state is good
/// and the asked command can be reached within the limits; the resolver, told what was sent, goes on from
/// there | | torque, beyond a limit or too fast | cut to the limit | by itself | | torque, not finite, or a
/// stale state | ramps to the fallback torque | by itself, at the same rate |
///
/// Reasons in the status: `command_not_finite`, `state_not_finite`, `state_stale`, `time_backwards`,
/// `interval_empty`, `interval_too_long`, `step_limited`, `outside_limits`, `torque_limited`.
/// Never steps, and never gives a number that is not finite, whatever comes in.
template <Interface I, std::size_t N, Real T = double>
class Guard {
 public:
  using Configuration = GuardConfiguration<N, T>;
  using Memory = GuardMemory<N, T>;

  /// Throws `ConfigurationError` for a number out of its range.
  explicit Guard(const Configuration& c)
      : limits_(c.limits),
        period_(c.period),
        longest_(c.longest_interval.value_or(5 * c.period)),
        stale_after_(c.stale_after.value_or(25 * c.period)),
        lead_(c.lead),
        torque_rate_(c.torque_rate) {
    const auto number = [](const auto& x) { return static_cast<double>(x); };
    require(period_ >= 100_us && period_ <= 1_s, "period [ns]", number(period_), "1e5 to 1e9 ns");
    require(longest_ >= period_ && longest_ <= 10_s, "longest interval [ns]", number(longest_),
            ">= period, <= 1e10 ns");
    require(stale_after_ >= period_ && stale_after_ <= 10_s, "stale after [ns]", number(stale_after_),
            ">= period, <= 1e10 ns");
    require(torque_rate_ > T(0) && torque_rate_ <= T(1e6), "torque rate", number(torque_rate_),
            "> 0, <= 1e6 1/s");
    for (std::size_t i = 0; i < N; ++i) require(lead_[i] > T(0), "lead", number(lead_[i]), "> 0 rad");
  }

  /// Takes over at a robot that has `command` and is at `measured`. A command that is not valid, or not
  /// plausible: nothing is let out until a guard is started with a good one.
  [[nodiscard]] SKINCTL_COLD Memory start(const JointCommand<N, T>& command,
                                          const State<N, T>& measured) const noexcept {
    Memory m;
    m.command = command;
    m.time = command.time;
    m.measured = measured;
    m.command.valid = command.valid && detail::is_plausible(command) && detail::is_plausible(measured) &&
                      detail::is_plausible(command.time) && detail::is_plausible(measured.time);
    return m;
  }

  /// The command that may leave at `now`.
  ///
  /// @param fallback  torque interface: what the robot is brought to when no torque can be trusted, such as
  ///                  gravity compensation with damping. Not finite: zero.
  SKINCTL_INLINE Guarded<N, T> pass(Memory& m, const JointCommand<N, T>& wish, const State<N, T>& measured,
                                    Nanoseconds now, const JointTorque<N, T>& fallback = {}) const noexcept {
    if (!m.command.valid) [[unlikely]]
      return {m.command, {}, true};
    if (now == m.time) [[unlikely]]
      return {m.command, Reason::interval_empty, !(wish.time == now)};
    Status status;
    Nanoseconds elapsed = period_;
    if (now < m.time || !detail::is_plausible(now)) {
      status |= Reason::time_backwards;
    } else {
      elapsed = now - m.time;
      if (elapsed > longest_) {
        elapsed = longest_;
        status |= Reason::interval_too_long;
      }
      m.time = now;
      see(m, measured, now, status);
    }
    const bool good = !status.has(Reason::time_backwards) && !status.has(Reason::state_stale);
    const bool finite = wish.valid && detail::is_plausible(wish);
    if (!finite) status |= Reason::command_not_finite;
    const T dt = seconds<T>(elapsed);
    if constexpr (I == Interface::torque) {
      return let_out(m, turn_torque(m, wish, good && finite, fallback, dt, status));
    } else {
      if (good && finite && wish.time == now && can_reach(m, wish, dt, status)) [[likely]] {
        m.command.assign(wish);
        return {wish.copy(), status, false};
      }
      return let_out(m, brake(m, dt, status));
    }
  }

 private:
  using Size = std::size_t;
  /// What rounding may add to a limit.
  static SKINCTL_INLINE T slack() noexcept { return T(1) + T(1024) * std::numeric_limits<T>::epsilon(); }

  SKINCTL_INLINE void see(Memory& m, const State<N, T>& measured, Nanoseconds now,
                          Status& status) const noexcept {
    if (!detail::is_plausible(measured)) {
      status |= Reason::state_not_finite;
    } else if (measured.time >= m.measured.time) {
      m.measured = measured;
      if (measured.time > now) m.measured.time = now;
    }
    if (now - m.measured.time > stale_after_) status |= Reason::state_stale;
  }

  /// Room of a command: of a position to the limits and to its lead over the measured one; of a velocity from
  /// where the robot is, counting in that it goes on the way it moves.
  SKINCTL_INLINE JointRoom<N, T> room(const Memory& m, const JointPosition<N, T>& command) const noexcept {
    using R = detail::Row<N, T>;
    const R q = m.measured.q;
    auto room = limits_.room(I == Interface::position ? command : m.measured.q);
    if constexpr (I == Interface::position) {
      const R ahead = R(command) - q, lead = lead_;
      smaller(room.above, lead - ahead).store(room.above);
      smaller(room.below, lead + ahead).store(room.below);
    } else {
      const R on = R(m.measured.dq) * R(seconds<T>(longest_)), zero = T(0);
      (R(room.above) - select(on < zero, on, zero)).store(room.above);
      (R(room.below) + select(on > zero, on, zero)).store(room.below);
    }
    return room;
  }

  /// Whether a motion within the limits leads from the last command to `wish` in `dt`, and leaves room to
  /// stop or brakes as hard as it may.
  SKINCTL_INLINE bool can_reach(const Memory& m, const JointCommand<N, T>& wish, const T& dt,
                                Status& status) const noexcept {
    using R = detail::Row<N, T>;
    const auto& last = m.command;
    const auto left = room(m, wish.position);
    const R eps = std::numeric_limits<T>::epsilon(), wide = slack(), zero = T(0);
    const R limit = limits_.velocity(), a = limits_.acceleration(), above = left.above, below = left.below;
    const R u0 = last.velocity, u = wish.velocity, du = u - u0, from = last.position, to = wish.position;
    const R q = magnitude(to) + magnitude(from), rounding = T(16) * eps * q;
    const R most = a * R(T(dt * slack())) + T(4) * eps * limit;
    auto steps = (magnitude(u) > limit * wide) & (magnitude(u) > magnitude(u0));
    steps = steps | (magnitude(du) > most);
    const R stop = u * u / (T(2) * a) / wide - T(16) * eps * (R(T(1)) + q);
    const auto rushes = !(magnitude(u) <= magnitude(u0) - (T(2) * a * R(dt) - most));
    auto outside = rushes & (((u > zero) & (stop > above)) | ((u < zero) & (stop > below)));
    if constexpr (I == Interface::position) {
      // With its acceleration limited, a joint reaches this far to both sides of where the mean speed leads.
      const R moved = to - from, straight = R(T(T(0.5) * dt)) * (u0 + u);
      const R aside = T(0.25) * (a * R(T(dt * dt * slack())) - du * du / a);
      steps = steps | (magnitude(moved - straight) > select(aside > zero, aside, zero) + rounding);
      outside =
          outside | ((above < -rounding) & (moved > rounding)) | ((below < -rounding) & (-moved > rounding));
    }
    const bool too_far = any(steps), beyond = any(outside);
    if (too_far) status |= Reason::step_limited;
    if (beyond) status |= Reason::outside_limits;
    return !too_far && !beyond;
  }

  SKINCTL_INLINE Guarded<N, T> let_out(Memory& m, Guarded<N, T> out) const noexcept {
    out.command.time = m.time;
    out.command.valid = true;
    m.command.assign(out.command);
    return out;
  }

  SKINCTL_COLD Guarded<N, T> brake(const Memory& m, const T& dt, Status status) const noexcept {
    Guarded<N, T> out{m.command, status, true};
    const auto& last = m.command;
    const auto motion = limits_.move(room(m, last.position), last.velocity, JointVelocity<N, T>{}, dt);
    out.command.torque = {};
    for (Size i = 0; i < N; ++i) {
      out.command.position[i] = last.position[i] + motion.displacement[i];
      out.command.velocity[i] = motion.velocity[i];
      out.command.acceleration[i] = (motion.velocity[i] - last.velocity[i]) / dt;
    }
    return out;
  }

  /// Towards the wished torque or the fallback, at most as fast as allowed.
  SKINCTL_INLINE Guarded<N, T> turn_torque(const Memory& m, const JointCommand<N, T>& wish, bool good,
                                           const JointTorque<N, T>& fallback, const T& dt,
                                           Status status) const noexcept {
    using R = detail::Row<N, T>;
    const R limit = limits_.torque(), step = T(torque_rate_ * dt) * limit, last = m.command.torque;
    const R rest = detail::is_finite(fallback) ? R(fallback) : R(T(0));
    const R wanted = good ? R(wish.torque) : rest;
    const R within = clamp(wanted, -limit, limit), given = clamp(within, last - step, last + step);
    const bool limited = good && any(within != wanted), slowed = any(given != within);
    if (limited) status |= Reason::torque_limited;
    if (slowed) status |= Reason::step_limited;
    Guarded<N, T> out{good ? wish : m.command, status, !good || limited || slowed};
    given.store(out.command.torque);
    return out;
  }

  JointLimits<N, T> limits_;
  Nanoseconds period_, longest_, stale_after_;
  JointPosition<N, T> lead_;
  T torque_rate_;
};

SKINCTL_END_NAMESPACE
