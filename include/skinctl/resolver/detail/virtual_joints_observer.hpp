// SPDX-License-Identifier: BSD-3-Clause
// The observer of a virtual robot's joints: what may a command owe to the real robot?
#pragma once

#include "skinctl/core/measurement.hpp"
#include "skinctl/resolver/detail/parameters.hpp"
#include "skinctl/resolver/memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The positions between which joints may come to rest.
template <std::size_t N, Real T>
struct Leash {
  JointPosition<N, T> least, most;  ///< bounds of the rest point [rad]
};

/// The part of `VirtualJoints` that compares the measured position with the expected one: the booked gap, and
/// the leash.
template <Interface Ix, std::size_t N, Real T, std::size_t History>
class VirtualJointsObserver {
  static_assert(has_servo<Ix>, "a joint that takes torques has no virtual state");

 public:
  using Servo = ServoOf<Ix, N, T, History>;
  using Memory = VirtualJointsMemory<N, T, History, typename Servo::Memory>;
  using Position = JointPosition<N, T>;
  using Velocity = JointVelocity<N, T>;
  using Torque = JointTorque<N, T>;
  using Row = detail::Row<N, T>;
  /// The results of a cycle's measurement: the bounds of its sub-steps.
  struct Begun {
    Leash<N, T> leash;
    struct ByVelocity {
      Velocity least, most;  ///< speeds from which joints stop before their ends [rad/s]
      Leash<N, T> early;     ///< rest points of q^ with which they do so, while the present speed goes on
      Leash<N, T> ends;      ///< rest points of q^ at their ends
      Velocity drift;        ///< velocity of q^ towards the measured position, without motion [rad/s]
    };
    struct ByPosition {};
    [[no_unique_address]] std::conditional_t<!takes_position(Ix), ByVelocity, ByPosition> speed;
    T dt;               ///< interval of the cycle [s]
    T share;            ///< time in which the servo carries the command out, over that interval
    bool held = false;  ///< the leash has held a joint that rests for 5 total delays
    Status status;
  };

  SKINCTL_COLD explicit VirtualJointsObserver(const RobotConfiguration<N, T>& c) : p_(c), servo_(c) {
    require(p_.delay / p_.period + 2 <= static_cast<std::int64_t>(History), "delay / period",
            milliseconds(p_.delay) / milliseconds(p_.period), "<= History - 2: commands under way");
  }
  [[nodiscard]] SKINCTL_INLINE const ResolverParameters<N, T>& parameters() const noexcept { return p_; }
  [[nodiscard]] SKINCTL_INLINE const Servo& servo() const noexcept { return servo_; }

 protected:
  /// Takes the measurement, and compares it with where the joints are due.
  ///
  /// @param pushed  joint torque of the contacts felt [N m].
  template <class Check>
  SKINCTL_INLINE Status measure(Memory& m, const State<N, T>& measured, Nanoseconds now, const Check& check,
                                const Torque& pushed) const noexcept {
    const State<N, T> taken{measured.time, Position(Row(measured.q) - m.gap), measured.dq};
    const State<N, T> before = m.measured;
    Status status = take_measurement(m.measured, taken, now, check);
    const bool taken_now = !status.any();
    const Position& expected = servo_.due(m.under_way, m.measured.time, pushed);
    Row residual = Row(m.measured.q) - expected;
    if constexpr (Servo::gives_way) {
      // Laws and leash compare with a robot that nothing pushes.
      const Row deflection = m.under_way.deflection;
      if (taken_now) (Row(m.measured.q) - deflection).store(m.measured.q);
      residual = Row(m.measured.q) - (Row(expected) - deflection);
    }
    if constexpr (!takes_position(Ix)) residual = residual - m.offset.value;
    residual.store(m.residual);
    if (taken_now && m.seen) find_speed(m, before);
    // The first measurement after a start shows whether the robot stands where it was started: the guard
    // judges.
    if constexpr (takes_position(Ix))
      if (taken_now && m.seen) book(m);
    m.seen = m.seen || taken_now;
    if (now - m.measured.time > p_.stale_after) status |= Reason::state_stale;
    return status;
  }
  /// Books the gap: where the robot went beyond B0 away from its commands, what it moved by itself is a
  /// gap and no obstacle. All else is owed by the commands, and the leash takes it back.
  ///
  /// With e, the distance to the nearest place between its command and where it is due: while |e| < B0/2 the
  /// farthest place is the measured one. If |e| > B0, and the robot is farther on that side by m, the gap
  /// takes `min(m, |e|)`. A robot that is early is between; noise books no more than its largest deflection,
  /// as it does not lead on.
  SKINCTL_INLINE void book(Memory& m) const noexcept {
    const Row y = m.measured.q, due = y - m.residual, command = m.q.value, q = y + m.gap;
    const Row least = smaller(due, command), most = due + command - least, away = y - clamp(y, least, most);
    if (all(magnitude(away) < T(near_share) * Row(p_.dead_band))) [[likely]]
      return q.store(m.farthest);
    book_gap(m, Position(q), Position(away));
  }
  /// Begins to watch joints on springs that the leash pulls back: nothing holds one that goes along, wherever
  /// it was before. Its distance is a gap, and would stay: the joint would swing between leash and law.
  SKINCTL_COLD void watch_return(Memory& m, std::uint64_t joints) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      if (((joints >> i) & 1u) == 0) continue;
      const T q = m.measured.q[i] + m.gap[i], some = T(along_share) * p_.dead_band[i];
      T& farthest = m.farthest[i];
      farthest = m.measured.q[i] < m.q.value[i] ? (farthest < q - some ? T(q - some) : farthest)
                                                : (farthest > q + some ? T(q + some) : farthest);
    }
  }
  /// E: by what a rest point may be ahead of the robot, or behind: the dead band; what acceleration owes
  /// before it shows, less and less where the robot does not answer; delay, lag and undeclared lag at the
  /// measured speed; and the way to stop from the speed that is both measured and commanded, as a joint that
  /// is told to rest owes none, whatever it says.
  SKINCTL_INLINE Leash<N, T> leash(const Memory& m) const noexcept {
    const Row dq = m.measured.dq, y = m.measured.q, zero = T(0);
    const Row both = clamp(Row(m.rate), smaller(dq, zero), dq - smaller(dq, zero));
    const Row stop = p_.limits.stopping_distance(magnitude(both));
    const Row answers = Row(T(1)) - p_.per_held * Row(m.held_for);
    Row most = Row(p_.dead_band) + Row(p_.owed) * answers + p_.latest * magnitude(dq);
    if constexpr (Servo::gives_way)
      if (m.returns != 0) [[unlikely]]
        tighten(m, most);
    Row above = y + most + select(both > zero, stop, zero),
        below = y - most - select(both < zero, stop, zero);
    if constexpr (takes_position(Ix)) {
      const Row upper = p_.limits.upper(), lower = p_.limits.lower();
      above = clamp(above, lower, upper), below = clamp(below, lower, upper);
    }
    return {Position(below), Position(above)};
  }
  /// Counts for how long the leash has held each joint that rests, up to 5 total delays; while a joint moves
  /// the time runs back. Returns whether it is so long for a joint that the leash holds now.
  SKINCTL_INLINE bool held(Memory& m, const T& dt) const noexcept {
    const T longest = T(settled_delays) * p_.total_delay;
    bool any = false;
    for (std::size_t i = 0; i < N; ++i) {
      const T u = m.measured.dq[i], most = p_.resting_speed[i];
      const bool rests = u <= most && -u <= most, cut = ((m.cut >> i) & 1u) != 0;
      if (rests && !cut) continue;
      m.held_for[i] = clamp(T(m.held_for[i] + (rests ? dt : T(-dt))), T(0), longest);
      any = any || (cut && !(m.held_for[i] < longest));
    }
    m.cut = 0;
    return any;
  }

  ResolverParameters<N, T> p_;
  Servo servo_;

 private:
  /// Distance over the dead band within which a robot is where it is told, and the farthest place follows it:
  /// at 1, noise at the edge of the dead band would book a little more each time.
  static constexpr double near_share = 0.5;
  /// Share of the dead band by which a joint goes along that is pulled back: noise, which would book a little
  /// each time, is less, and a joint that swings between law and leash goes further.
  static constexpr double along_share = 0.25;

  /// Takes the mean speed since the last measurement where it is more than the measured one: of a robot that
  /// does not tell its speed, or that holds each position, so that it is measured when it has slowed down.
  /// What may be noise owes no more than the dead band.
  SKINCTL_INLINE void find_speed(Memory& m, const State<N, T>& before) const noexcept {
    const T passed = seconds<T>(m.measured.time - before.time);
    if (!(passed > T(0))) return;
    const Row moved = Row(m.measured.q) - before.q, way = magnitude(moved), top = p_.limits.velocity();
    const auto faster = (way > passed * magnitude(Row(m.measured.dq))) &
                        (way > T(T(resting_share) * passed / p_.total_delay) * Row(p_.dead_band));
    if (any(faster))
      select(faster, clamp(T(T(1) / passed) * moved, -top, top), m.measured.dq).store(m.measured.dq);
  }
  /// Shortens the leash of joints that it pulls back, so that it is seen whether they go along.
  SKINCTL_COLD void tighten(const Memory& m, Row& most) const noexcept {
    Position bands;
    for (std::size_t i = 0; i < N; ++i)
      if (((m.returns >> i) & 1u) != 0) bands[i] = p_.dead_band[i];
    most = most - T(along_share) * Row(bands);
  }
  SKINCTL_COLD void book_gap(Memory& m, const Position& q, const Position& away) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const T side = away[i] < T(0) ? T(-1) : T(1), off = side * away[i], band = p_.dead_band[i];
      const T farther = side * (q[i] - m.farthest[i]);
      const bool books = off > band && farther > T(0);
      if (books || off < T(near_share) * band) m.farthest[i] = q[i];
      if (!books) continue;
      const T taken = side * (farther < off ? farther : off);
      m.gap[i] = m.gap[i] + taken;
      m.measured.q[i] = m.measured.q[i] - taken;
      m.residual[i] = m.residual[i] - taken;
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
