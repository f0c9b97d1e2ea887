// SPDX-License-Identifier: BSD-3-Clause
// The motion of a virtual robot's joints, and the command that it becomes.
#pragma once

#include <limits>

#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/resolver/detail/virtual_joints_observer.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of `VirtualJoints` that plans: one state, the last command with its speed and acceleration, and
/// nothing else that moves it.
///
/// Of a step towards a wish W, and of the quickest stop B, it takes the largest share of W with which the
/// joint still comes to rest where it may: inside its ends, and inside the leash. A joint whose rest point is
/// beyond the leash comes back as hard as its limits allow. Both are kept by limits that are convex in the
/// motion: a mix of two allowed motions is allowed.
template <Interface Ix, std::size_t N, Real T, std::size_t History>
class VirtualJointsMotion : public VirtualJointsObserver<Ix, N, T, History> {
  using Base = VirtualJointsObserver<Ix, N, T, History>;

 public:
  using Memory = typename Base::Memory;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Torque = typename Base::Torque;
  using Row = typename Base::Row;
  using Begun = typename Base::Begun;

  using Base::Base;

  /// The motion of a sub-step.
  struct Planned {
    Position displacement;         ///< displacement in the sub-step [rad]
    Velocity rate;                 ///< velocity at its end [rad/s]
    Velocity own;                  ///< velocity for laws, without a return by the leash [rad/s]
    JointAcceleration<N, T> last;  ///< mean acceleration; with limits of jerk at the end [rad/s^2]
    std::uint64_t cut = 0;         ///< bit i: the leash holds joint i back
    std::uint64_t returns = 0;     ///< bit i: the leash pulls joint i back
    Status status;
  };

  /// Plans one sub-step of `h` seconds towards the velocity `v1`, or to rest while it brakes.
  ///
  /// A command is carried out in a period, whatever time has passed: of a late cycle the joints get that
  /// share, and what they missed is not caught up.
  ///
  /// @param mover  limits of jerk, or `Abrupt`.
  template <class Mover>
  [[nodiscard]] SKINCTL_INLINE Planned plan(const Memory& m, const Begun& c, const Velocity& v1, const T& h,
                                            const Mover& mover) const noexcept {
    const T given = c.share * h;
    Planned out;
    Velocity wish = m.brakes ? Velocity{} : v1;
    JointRoom<N, T> room;
    if constexpr (takes_position(Ix)) {
      room = p_.limits.room(m.q.value);
    } else {
      room.above = room.below = Position::constant(std::numeric_limits<T>::infinity());
      const Row asked = wish;
      clamp(asked, c.speed.least, c.speed.most).store(wish);
      if (any(asked != Row(wish))) out.status |= Reason::position_limited;
    }
    const Row q = m.q.value;
    const JointRoom<N, T> leash{Position(q - c.leash.least), Position(Row(c.leash.most) - q)};
    const auto take_motion = [&](const auto& motion) SKINCTL_INLINE_LAMBDA {
      out.displacement = motion.displacement;
      out.rate = motion.velocity;
      out.own = motion.velocity;
      out.status |= motion.status;
    };
    if constexpr (std::is_same_v<Mover, Abrupt>) {
      auto motion = p_.limits.move_inlined(room, m.rate, wish, given);
      const Row u = motion.velocity, stop = p_.limits.stopping_distance(u);
      const Row rest = Row(motion.displacement) + select(u < Row(T(0)), -stop, stop);
      if (!m.brakes && any((rest > leash.above) | (-rest > leash.below))) [[unlikely]]
        out.cut = hold_back(motion, leash, m.rate, given);
      take_motion(motion);
      ((Row(motion.velocity) - m.rate) * T(T(1) / given)).store(out.last);
    } else {
      auto motion =
          m.brakes ? mover.brake(room, m.rate, m.last, given) : mover.move(room, m.rate, m.last, wish, given);
      if (!m.brakes)
        out.cut = mover.hold_back(motion, room, leash, m.rate, m.last, given, takes_position(Ix));
      if constexpr (!takes_position(Ix)) {
        const auto to = [&](const Leash<N, T>& ends) SKINCTL_INLINE_LAMBDA {
          return JointRoom<N, T>{Position(q - ends.least), Position(Row(ends.most) - q)};
        };
        if (mover.hold_back(motion, room, to(c.speed.early), m.rate, m.last, given, false) != 0)
          out.status |= Reason::position_limited;
        // A cycle that comes late holds a velocity for longer: no stop within the jerk's limit may be left.
        if (m.late) [[unlikely]]
          mover.brake_before(motion, to(c.speed.ends), m.rate, m.last, given, p_.reaction);
      }
      take_motion(motion);
      out.last = motion.acceleration;
    }
    if (out.cut != 0) out.status |= Reason::lead_limited;
    if ((m.returns | out.cut) != 0) [[unlikely]]
      stand(m, wish, out);
    return out;
  }
  /// Takes the motion of a sub-step of `h` seconds.
  SKINCTL_INLINE Status take(Memory& m, [[maybe_unused]] const Begun& c, const Planned& planned,
                             [[maybe_unused]] const T& h) const noexcept {
    if constexpr (takes_position(Ix)) {
      const Row q = m.q.value, lower = p_.limits.lower(), upper = p_.limits.upper();
      m.q.add(planned.displacement);
      const Row next = m.q.value;
      const auto passed = ((next > upper) & (q <= upper)) | ((next < lower) & (q >= lower));
      if (any(passed)) [[unlikely]] {
        select(passed, clamp(next, lower, upper), next).store(m.q.value);
        select(passed, Row(T(0)), m.q.rest).store(m.q.rest);
      }
    } else {
      const Row drift = h * Row(c.speed.drift);
      m.q.add(T(T(0.5) * h) * (Row(m.rate) + planned.rate) + drift);
      m.offset.add(drift);
    }
    m.rate = planned.rate;
    m.v = planned.own;
    m.last = planned.last;
    m.cut |= planned.cut;
    if constexpr (Base::Servo::gives_way)
      if ((planned.returns & ~m.returns) != 0) [[unlikely]]
        this->watch_return(m, planned.returns & ~m.returns);
    m.returns = planned.returns;
    return planned.status;
  }

  /// Virtual joints by velocity are where the velocities sent bring them: half of a period of the newest is
  /// to come.
  SKINCTL_INLINE void at_sent(Memory& m) const noexcept {
    for (std::size_t i = 0; i < N; ++i)
      m.q.set(i, m.sent.value[i] + m.offset.value[i] + T(0.5) * p_.cycle * m.rate[i]);
  }

 protected:
  using Base::p_;
  using Base::servo_;

  /// Writes the command of the cycle, and sends it to the servo.
  SKINCTL_INLINE void publish(Memory& m, const Begun& c, const Torque& torque, bool smooth) const noexcept {
    auto& command = m.command;
    const Row before = command.velocity, u = m.rate;
    command.time = m.time;
    command.position = m.q.value;
    command.velocity = m.rate;
    if (smooth) {
      command.acceleration = m.last;
    } else {
      ((u - before) / Row(c.share * c.dt)).store(command.acceleration);
    }
    command.torque = torque;
    command.valid = true;
    servo_.send(m.under_way, m.time, under_way(m), !takes_position(Ix) ? command.velocity : Velocity{});
  }
  /// The position that the servo gets: that of the command, or by velocity where the sent velocities lead.
  [[nodiscard]] static SKINCTL_INLINE const Position& under_way(const Memory& m) noexcept {
    return !takes_position(Ix) ? m.sent.value : m.q.value;
  }

 private:
  /// Lets joints that the leash pulls back stand for the laws: their way back is no momentum, which would
  /// lead on from there. They go on with what laws ask for as soon as that is the motion.
  SKINCTL_COLD static void stand(const Memory& m, const Velocity& wish, Planned& out) noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const std::uint64_t bit = std::uint64_t(1) << i;
      const T u = out.rate[i];
      if ((out.cut & bit) == 0 && ((m.returns & bit) == 0 || !(m.rate[i] * u > T(0)))) continue;
      out.own[i] = u < T(0) ? clamp(wish[i], u, T(0)) : clamp(wish[i], T(0), u);
      if (out.own[i] != u) out.returns |= bit;
    }
  }
  /// Changes a motion from the speed `u0` such that its rest point is inside `leash`, or gets there as fast
  /// as it can; by velocity nothing is sent back, as the robot owes no way. Returns the joints whose motion
  /// it changed.
  SKINCTL_COLD std::uint64_t hold_back(JointMotion<N, T>& motion, const JointRoom<N, T>& leash,
                                       const Velocity& u0, const T& h) const noexcept {
    const T half = T(0.5) * h;
    std::uint64_t cut = 0;
    for (std::size_t i = 0; i < N; ++i) {
      const T limit = p_.limits.acceleration()[i], brake = limit * braking_share<T>, from = u0[i];
      // The speed whose rest point is `way` ahead: h (u0 + u)/2 + u |u| / (2 a) = way.
      const auto to_rest = [&](const T& way) {
        const T d = way - half * from;
        return d < T(0) ? T(-speed_to_stop(T(-d), half, brake)) : speed_to_stop(d, half, brake);
      };
      const T wish = motion.velocity[i];
      T most = to_rest(leash.above[i]), least = to_rest(T(-leash.below[i]));
      if (!takes_position(Ix) && most < T(0)) most = T(0);
      if (!takes_position(Ix) && least > T(0)) least = T(0);
      T u = wish > most ? most : (wish < least ? least : wish);
      if (u == wish) continue;
      cut |= std::uint64_t(1) << i;
      const T way = wish > most ? leash.above[i] : T(-leash.below[i]), dv = limit * h;
      const T top = p_.limits.velocity()[i], straight = half * from;
      u = clamp(clamp(u, T(-top), top), T(from - dv), T(from + dv));
      // It rests before it turns, where it may, and stays where it is if that is as good as rounding.
      const bool turns = (u < T(0)) != (from < T(0)) && from != T(0) && u != T(0);
      if (turns || (from == T(0) && way <= rounding() && -way <= rounding())) u = T(0);
      motion.velocity[i] = u;
      motion.displacement[i] = half * (from + u);
      if (u != T(0) || from * from > dv * dv) continue;
      const T soon = from * (from < T(0) ? -from : from) / (T(2) * limit);
      motion.displacement[i] = from < T(0) ? clamp(way, straight, soon) : clamp(way, soon, straight);
    }
    return cut;
  }
  /// Distance that is but rounding [rad].
  [[nodiscard]] static T rounding() noexcept { return T(1024) * std::numeric_limits<T>::epsilon(); }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
