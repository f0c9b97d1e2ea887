// The joints of a virtual robot: observer of the real ones, limits, commands.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/resolver/detail/virtual_joints_motion.hpp"
#include "skinctl/resolver/interval.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// How long the gap of commands that have not moved yet is learnt [s].
inline constexpr double settling_time = 2;

/// The resolver's treatment of joints that take positions or velocities, without the laws: the observer with
/// the declared delay and lag, limits and max lead, the modes, the command. It has no model, so that it
/// serves a part of a robot's joints while the others take torques.
template <Interface I, std::size_t N, Real T, std::size_t History>
class VirtualJoints : public VirtualJointsMotion<I, N, T, History> {
  using Base = VirtualJointsMotion<I, N, T, History>;

 public:
  using Memory = typename Base::Memory;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Torque = typename Base::Torque;
  using Row = typename Base::Row;
  using Correction = typename Base::Correction;
  /// The begin of a cycle.
  struct Begun {
    Correction correction;
    T dt;  ///< interval of the cycle [s]
    Status status;
  };

  using Base::Base;

  [[nodiscard]] SKINCTL_COLD Memory start(const State<N, T>& measured) const noexcept {
    Memory m;
    if (!is_plausible(measured) || !is_plausible(measured.time)) return m;
    m.started = true;
    m.time = measured.time;
    m.measured = measured;
    const T ahead = seconds<T>(p_.delay) + p_.lag;
    Position command = measured.q;
    for (std::size_t i = 0; i < N; ++i) {
      const T most = p_.limits.velocity()[i];
      const T dq = clamp(measured.dq[i], T(-most), most);
      if ((dq < T(0) ? -dq : dq) > p_.resting_speed[i]) {
        m.v[i] = dq;
        command[i] = measured.q[i] + dq * ahead;
      }
      m.q.set(i, command[i]);
      m.sent.set(i, command[i]);
    }
    m.rate = m.v;
    m.settles_for = T(settling_time);
    m.under_way = servo_.start(measured.time, measured.q, m.v);
    m.command.time = m.time;
    m.command.position = command;
    m.command.velocity = m.v;
    m.command.valid = true;
    return m;
  }
  /// The same from the position that the robot was told; a gap to the measured one is agreed to.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<N, T>& measured, const Position& told) const noexcept {
    const Row gap = Row(measured.q) - told;
    if (!all(magnitude(gap) <= Row(T(plausible)))) return {};
    Memory m;
    if (all(magnitude(gap) <= Row(p_.largest_gap))) m = start(State<N, T>{measured.time, told, measured.dq});
    gap.store(m.gap);
    m.gap_told = true;
    return m;
  }

  /// Begins a cycle: takes the measurement and computes the correction for the sub-steps.
  ///
  /// @param pushed  joint torque of the contacts felt [N m].
  template <class Check = AnyState>
  SKINCTL_INLINE Begun begin(Memory& m, const State<N, T>& measured, const Interval& interval,
                             const Check& check = {}, const Torque& pushed = {}) const noexcept {
    const T dt = seconds<T>(interval.to - interval.from);
    if (interval.clock_set || interval.to - m.command.time > 1s + p_.longest_interval) [[unlikely]] {
      set_clock(m, interval);
    } else if constexpr (takes_velocity(I)) {
      // The velocity that was sent has been held up to now.
      for (std::size_t i = 0; i < N; ++i)
        m.sent.add(i, m.command.velocity[i] * seconds<T>(interval.to - m.command.time));
    }
    const Status status = interval.status | measure(m, measured, interval.to, check, pushed);
    const Begun out{correct(m, interval.to, dt), dt, status};
    m.mode_for = m.mode_for + dt;
    choose_mode(m, out.correction, status.has(Reason::state_stale));
    return out;
  }
  /// Ends a cycle: computes `command`, which is sent.
  SKINCTL_INLINE Status end(Memory& m, const Begun& begun, const Torque& torque) const noexcept {
    Status status;
    if (m.mode == ResolverMode::blocked) status |= Reason::blocked;
    if (m.mode == ResolverMode::displaced) status |= Reason::displaced;
    if (m.stop) status |= Reason::stopping;
    if (begun.correction.lags) [[unlikely]]
      status |= Reason::lead_limited;
    if (!p_.limits.hold(m.q.value)) status |= Reason::outside_limits;
    return status | publish(m, begun.correction, torque, begun.dt);
  }

  /// The user agrees to go on. A displaced robot follows again from where it stands: the residual becomes the
  /// gap, if it is at most `largest_gap`; otherwise it stays displaced.
  SKINCTL_COLD void resume(Memory& m) const noexcept {
    m.stop = false;
    if (m.mode != ResolverMode::displaced) return;
    const Row gap = Row(m.gap) + m.residual;
    if (any(!(magnitude(gap) <= Row(p_.largest_gap)))) return;
    gap.store(m.gap);
    m.measured.q -= m.residual;
    m.residual = {};
    m.watched = false;
    for (auto& w : m.watch) {
      w = {.slack = w.slack};
      m.watched = m.watched || w.slack > T(0);
    }
    for (T& t : m.off_for) t = T(0);
    m.mode = ResolverMode::following;
    m.mode_for = T(0);
    m.settles_for = T(settling_time);
  }

  /// See `Resolver::stops_or_corrects`.
  [[nodiscard]] static SKINCTL_INLINE bool stops_or_corrects(const Memory& m) noexcept {
    bool any = m.mode != ResolverMode::following || m.rate != m.v;
    for (const T& t : m.off_for) any = any || t > T(0);
    return any;
  }

  /// `command` was sent instead of the last one.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<N, T>& command) const noexcept {
    if (!m.started || !command.valid) return;
    m.command = command;
    m.command.time = m.time;
    m.behind = false;
    // A correction is no velocity of the virtual robot's own: it keeps what it had of the velocity that was sent.
    for (std::size_t i = 0; i < N; ++i) {
      const T u = command.velocity[i];
      m.v[i] = m.v[i] == m.rate[i] ? u : (u < T(0) ? clamp(m.v[i], u, T(0)) : clamp(m.v[i], T(0), u));
    }
    m.rate = command.velocity;
    m.last = {};
    // A velocity is held for a period, half of which is still to come.
    const T behind = takes_velocity(I) ? T(0.5) * p_.cycle : T(0);
    for (std::size_t i = 0; i < N; ++i) {
      if constexpr (takes_position(I)) m.sent.set(i, command.position[i]);
      m.q.set(i, m.sent.value[i] + m.offset.value[i] + behind * m.v[i]);
    }
    servo_.correct(m.under_way, m.sent.value, takes_velocity(I) ? command.velocity : Velocity{});
  }

 private:
  using Base::choose_mode;
  using Base::correct;
  using Base::measure;
  using Base::p_;
  using Base::publish;
  using Base::servo_;

  /// A clock that leapt, or was set.
  SKINCTL_COLD void set_clock(Memory& m, const Interval& interval) const noexcept {
    servo_.restart(m.under_way, interval.from);
    if constexpr (takes_velocity(I)) {
      servo_.correct(m.under_way, m.sent.value, m.command.velocity);
      for (std::size_t i = 0; i < N; ++i)
        m.sent.add(i, m.command.velocity[i] * seconds<T>(interval.to - interval.from));
    }
    m.command.time = interval.from;
    if (m.measured.time > interval.from) m.measured.time = interval.from;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
