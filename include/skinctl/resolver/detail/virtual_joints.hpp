// SPDX-License-Identifier: BSD-3-Clause
// The joints of a virtual robot: observer of the real ones, limits, commands.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/resolver/detail/virtual_joints_motion.hpp"
#include "skinctl/resolver/interval.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The resolver's treatment of joints that take positions or velocities, without the laws: the observer with
/// the declared delay and lag, limits and leash, the command. It has no model, so that it
/// serves a part of a robot's joints while the others take torques.
template <Interface Ix, std::size_t N, Real T, std::size_t History>
class VirtualJoints : public VirtualJointsMotion<Ix, N, T, History> {
  using Base = VirtualJointsMotion<Ix, N, T, History>;

 public:
  using Memory = typename Base::Memory;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Torque = typename Base::Torque;
  using Row = typename Base::Row;
  using Begun = typename Base::Begun;

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
        m.v[i] = m.rate[i] = dq;
        command[i] = measured.q[i] + dq * ahead;
      }
      m.q.set(i, command[i]);
      if constexpr (!takes_position(Ix)) {
        m.sent.set(i, command[i]);
        m.offset.set(i, T(-0.5) * p_.cycle * m.v[i]);
      }
    }
    m.farthest = measured.q;
    m.under_way = servo_.start(measured.time, measured.q, m.v);
    m.command.time = m.time;
    m.command.position = command;
    m.command.velocity = m.v;
    m.command.valid = true;
    return m;
  }
  /// The memory of joints that start at `told`, the position that the robot was told last; a gap of up to
  /// `largest_gap` to the measured one is taken as it is.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<N, T>& measured, const Position& told) const noexcept {
    const Row gap = Row(measured.q) - told;
    if (!all(magnitude(gap) <= Row(T(plausible)))) return {};
    Memory m;
    if (all(magnitude(gap) <= Row(p_.largest_gap))) m = start(State<N, T>{measured.time, told, measured.dq});
    gap.store(m.gap);
    m.gap_told = true;
    return m;
  }

  /// Begins a cycle: takes the measurement, from which the bounds of its sub-steps follow.
  ///
  /// @param pushed  joint torque of the contacts felt [N m].
  template <class Check = AnyState>
  SKINCTL_INLINE Begun begin(Memory& m, const State<N, T>& measured, const Interval& interval,
                             const Check& check = {}, const Torque& pushed = {}) const noexcept {
    Begun out;
    out.dt = seconds<T>(interval.to - interval.from);
    out.share = seconds<T>(interval.command_duration(p_.period)) / out.dt;
    if (interval.clock_set || interval.to - m.command.time > clock_leap + p_.longest_interval) [[unlikely]] {
      set_clock(m, interval);
    } else if constexpr (!takes_position(Ix)) {
      m.late = out.share < T(1) || (m.late && !(m.rate == Velocity{}));
      // The velocity that was sent has been held up to now.
      for (std::size_t i = 0; i < N; ++i)
        m.sent.add(i, m.command.velocity[i] * seconds<T>(interval.to - m.command.time));
    }
    out.status = interval.status | this->measure(m, measured, interval.to, check, pushed);
    if constexpr (takes_position(Ix))
      m.displaced = m.displaced || any(magnitude(Row(m.gap)) > Row(p_.largest_gap));
    out.leash = this->leash(m);
    if constexpr (!takes_position(Ix)) {
      if (!out.status.has(Reason::state_stale)) [[likely]] {  // an old state does not tell where the robot is
        m.displaced = m.displaced || any(beyond(m, out.leash) > Row(p_.largest_gap));
        if (!m.displaced) take_in(m, out);
      }
      before_ends(m, out);
    }
    m.brakes = m.stop || m.displaced || out.status.has(Reason::state_stale);
    out.held = this->held(m, out.dt);
    return out;
  }
  /// Ends a cycle: computes `command`, which is sent.
  ///
  /// @param smooth  whether limits of jerk have moved the joints.
  SKINCTL_INLINE Status end(Memory& m, const Begun& begun, const Torque& torque, bool smooth) const noexcept {
    Status status;
    if (begun.held) status |= Reason::blocked;
    if (m.displaced) status |= Reason::displaced;
    if (m.stop) status |= Reason::stopping;
    if (!p_.limits.hold(m.q.value)) status |= Reason::outside_limits;
    this->publish(m, begun, torque, smooth);
    return status;
  }

  /// Goes on with the user's consent: so does a displaced robot whose gap is `largest_gap` at most, and one
  /// by velocity from where it is, as its commands name no position.
  SKINCTL_COLD void resume(Memory& m) const noexcept {
    if (!takes_position(Ix) && m.displaced) {
      const Row moved = m.residual;
      m.offset.add(moved);
      m.q.add(moved);
      m.residual = {};
    }
    m.stop = m.displaced = false;  // one that still is displaced is found again in the next cycle
  }

  /// Tells that `command` was sent instead of the last one: it is the state from which the joints go on.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<N, T>& command) const noexcept {
    if (!m.started || !command.valid) return;
    m.command = command;
    m.command.time = m.time;
    m.rate = m.v = command.velocity;
    m.last = command.acceleration;
    m.returns = 0;
    if constexpr (takes_position(Ix)) {
      for (std::size_t i = 0; i < N; ++i) m.q.set(i, command.position[i]);
    } else {
      this->at_sent(m);
    }
    servo_.correct(m.under_way, this->under_way(m), !takes_position(Ix) ? command.velocity : Velocity{});
  }

 private:
  /// Time without a cycle, beyond the longest interval, by which a clock was set: no loop stands so long.
  static constexpr Nanoseconds clock_leap = 1s;

  using Base::p_;
  using Base::servo_;

  /// Distance of q^ from the leash, 0 inside [rad].
  [[nodiscard]] static SKINCTL_INLINE Row beyond(const Memory& m, const Leash<N, T>& leash) noexcept {
    const Row q = m.q.value;
    return magnitude(q - clamp(q, leash.least, leash.most));
  }
  /// Virtual joints by velocity stay with the real ones: q^ goes to the leash at once, and slowly to the
  /// measured position.
  SKINCTL_INLINE void take_in(Memory& m, Begun& c) const noexcept {
    const Row q = m.q.value;
    const Row moved = clamp(q, c.leash.least, c.leash.most) - q;
    m.offset.add(moved);
    m.q.add(moved);
    (Row(m.residual) - moved).store(m.residual);
    (p_.drift * Row(m.residual)).store(c.speed.drift);
  }
  /// Finds the speeds from which joints by velocity stop before their ends, later than declared by the
  /// undeclared lag.
  SKINCTL_INLINE void before_ends(const Memory& m, Begun& out) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      // Position of the real robot when it has carried out all commands sent up to now.
      const T arrives = m.measured.q[i] + (m.sent.value[i] - m.under_way.reached[i]);
      const T late = p_.undeclared * m.measured.dq[i], brake = p_.limits.acceleration()[i] * braking_share<T>;
      const T above = p_.limits.upper()[i] - arrives, below = arrives - p_.limits.lower()[i];
      const T up = late > T(0) ? T(above - late) : above, down = late < T(0) ? T(below + late) : below;
      const T on = p_.reaction * m.rate[i];
      out.speed.most[i] = speed_to_stop(up, p_.reaction, brake);
      out.speed.least[i] = -speed_to_stop(down, p_.reaction, brake);
      // A joint beyond its end may rest where it is: no single step leads back inside.
      const T q = m.q.value[i];
      out.speed.early.most[i] = q + (above < T(0) ? T(0) : up) - (on > T(0) ? on : T(0));
      out.speed.early.least[i] = q - (below < T(0) ? T(0) : down) - (on < T(0) ? on : T(0));
      out.speed.ends.most[i] = q + (above < T(0) ? T(0) : above);
      out.speed.ends.least[i] = q - (below < T(0) ? T(0) : below);
    }
  }

  /// Moves the times of a memory after a clock that leapt, or was set.
  SKINCTL_COLD void set_clock(Memory& m, const Interval& interval) const noexcept {
    servo_.restart(m.under_way, interval.from);
    if constexpr (!takes_position(Ix)) {
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
