// The motion of a virtual robot's joints, and the command that follows it.
#pragma once

#include "skinctl/resolver/detail/virtual_joints_observer.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of `VirtualJoints` that moves them within their limits and the max lead.
template <Interface I, std::size_t N, Real T, std::size_t History>
class VirtualJointsMotion : public VirtualJointsObserver<I, N, T, History> {
  using Base = VirtualJointsObserver<I, N, T, History>;

 public:
  using Memory = typename Base::Memory;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Torque = typename Base::Torque;
  using Row = typename Base::Row;
  using Correction = typename Base::Correction;

  using Base::Base;

  /// One sub-step towards the velocity `v1` (ignored where the mode is another than `following`).
  SKINCTL_INLINE Status move(Memory& m, const Correction& c, const Velocity& v1, const T& h) const noexcept {
    const bool follows = m.mode == ResolverMode::following;
    Velocity back;
    if (m.mode == ResolverMode::blocked) [[unlikely]]
      back = way_back(m, h);
    return shift(m, c, follows ? c.rate : back, c.off || !follows, v1, h);
  }

 protected:
  using Base::p_;
  using Base::servo_;

  SKINCTL_INLINE Status publish(Memory& m, const Correction& c, const Torque& torque,
                                const T& dt) const noexcept {
    Status status;
    auto& command = m.command;
    const Row last = command.velocity;
    m.command_span = dt;
    if constexpr (takes_position(I)) {
      const Row moved = Row(m.q.value) - m.sent.value;
      if (!m.behind && (!(dt > p_.cycle) || is_near(moved))) [[likely]] {
        m.sent.copy(m.q);
        copy_row(m.rate, command.velocity);
      } else {
        status = follow(m, dt);
      }
    } else {
      // The command follows the virtual robot's position, within the same limits. A velocity is held for a period,
      // half of which is still to come.
      auto room = p_.limits.room(m.sent.value);
      const Row rate = m.rate, sent = m.sent.value, goal = m.q.value - T(T(0.5) * p_.cycle) * rate;
      const Row target =
          clamp(rate + p_.catch_up * (goal - sent - m.offset.value), c.speed.least, c.speed.most);
      room.above = room.below = Position::constant(std::numeric_limits<T>::infinity());
      const auto motion = p_.limits.move(room, Velocity(last), Velocity(target), dt);
      status = motion.status;
      command.velocity = motion.velocity;
    }
    command.time = m.time;
    copy_row(takes_position(I) ? m.sent.value : m.q.value, command.position);
    ((Row(command.velocity) - last) / Row(dt)).store(command.acceleration);
    copy_row(torque, command.torque);
    command.valid = true;
    servo_.send(m.under_way, m.time, m.sent.value, takes_velocity(I) ? command.velocity : Velocity{});
    return status;
  }

 private:
  SKINCTL_INLINE Status shift(Memory& m, const Correction& c, const Velocity& rate, bool off,
                              const Velocity& v1, const T& h) const noexcept {
    Status status;
    JointRoom<N, T> room = p_.limits.room(m.q.value);
    const Row zero = T(0), max_lead = p_.max_lead, e = Row(m.q.value) - m.measured.q;
    const Row above = max_lead - e, below = max_lead + e;
    const Row most = select(above > zero, above * p_.per_delay, zero);
    const Row least = select(below > zero, -below * p_.per_delay, zero);
    Row v = v1;
    auto by_lead = above < room.above;
    if constexpr (takes_position(I)) {
      by_lead = by_lead | (below < room.below);
      smaller(room.above, above).store(room.above);
      smaller(room.below, below).store(room.below);
    } else {
      room.above = room.below = Position::constant(std::numeric_limits<T>::infinity());
      if (any((v > c.speed.most) | (v < c.speed.least))) status |= Reason::position_limited;
      v = clamp(v, c.speed.least, c.speed.most);
    }
    if (any((v > most) | (v < least))) status |= Reason::lead_limited;
    auto motion = p_.limits.move_inlined(room, m.v, Velocity(clamp(v, least, most)), h);
    const Row last = m.v, own = motion.velocity;
    ((own - last) * T(T(1) / h)).store(m.last);
    own.store(m.v);
    Status found = motion.status;
    std::uint64_t braked = motion.braked;
    if constexpr (takes_position(I)) {
      if (off || any(last != m.rate)) {
        motion = p_.limits.move(room, m.rate, Velocity(clamp(own + rate, least, most)), h);
        found |= motion.status;
        braked |= motion.braked;
      }
      const Row q = m.q.value, lower = p_.limits.lower(), upper = p_.limits.upper();
      m.q.add(motion.displacement);
      const Row next = m.q.value;
      const auto passed = ((next > upper) & (q <= upper)) | ((next < lower) & (q >= lower));
      if (any(passed)) [[unlikely]] {
        select(passed, clamp(next, lower, upper), next).store(m.q.value);
        select(passed, zero, m.q.rest).store(m.q.rest);
      }
    } else {
      for (std::size_t i = 0; i < N; ++i) {
        const T corrected = h * rate[i];
        m.offset.add(i, corrected);
        m.q.add(i, motion.displacement[i] + corrected);
        const T near = m.measured.q[i] - p_.max_lead[i], far = m.measured.q[i] + p_.max_lead[i];
        const T kept = clamp(m.q.value[i], near, far);
        if (kept != m.q.value[i]) {
          m.offset.add(i, kept - m.q.value[i]);
          m.q.set(i, kept);
        }
      }
    }
    copy_row(motion.velocity, m.rate);
    const std::uint64_t lead_acts = takes_position(I) && braked != 0 ? by_lead.bits() : 0;
    status |= found.without(Reason::position_limited);
    if ((braked & lead_acts) != 0) status |= Reason::lead_limited;
    if ((braked & ~lead_acts) != 0) status |= Reason::position_limited;
    return status;
  }
  /// Velocity towards the place where the real robot was blocked, that ends there at rest. (The present measurement
  /// would move along with a robot that is not blocked after all.)
  SKINCTL_COLD Velocity way_back(const Memory& m, const T& h) const noexcept {
    Velocity u;
    for (std::size_t i = 0; i < N; ++i) {
      const T d = m.back[i] - m.q.value[i];
      const T far = d < T(0) ? T(-d) : d;
      const T soft = far / (p_.total_delay + h);
      const T hard = speed_to_stop(far, h, T(T(0.5) * p_.limits.acceleration()[i]));
      T speed = soft < hard ? soft : hard;
      const auto& w = m.watch[i];
      if (takes_position(I) && w.size > T(0) && w.side * d > T(0) && w.most < speed) speed = w.most;
      u[i] = d < T(0) ? T(-speed) : speed;
    }
    return u;
  }
  /// The sent position follows the virtual one within the same limits. A position is held until the next one
  /// comes, so that the robot carries a command out in a period, whatever time has passed: after a late cycle the
  /// sent position moves as far as in a punctual one at most, and catches up.
  SKINCTL_NOINLINE Status follow(Memory& m, const T& dt) const noexcept {
    const Row last = m.command.velocity, rate = m.rate, sent = m.sent.value, a = p_.limits.acceleration();
    const Row ahead = m.q.value - sent, e = sent - m.measured.q, max_lead = p_.max_lead;
    auto room = p_.limits.room(m.sent.value);
    smaller(room.above, max_lead - e).store(room.above);
    smaller(room.below, max_lead + e).store(room.below);
    const auto within = [&](const T& h) {
      const Position left(ahead - T(0.5) * h * (last + rate));
      const Velocity level(rate);
      Velocity target;
      for (std::size_t i = 0; i < N; ++i) {
        const T d = left[i] < T(0) ? T(-left[i]) : left[i], brake = T(0.5) * p_.limits.acceleration()[i];
        const T speed = d > T(4) * h * h * brake ? speed_to_stop(d, h, brake) : T(d / h);
        target[i] = level[i] + (left[i] < T(0) ? T(-speed) : speed);
      }
      return p_.limits.move(room, Velocity(last), target, h);
    };
    // The sent position is on the virtual one again, as soon as a motion within the limits leads there.
    const T h = dt > p_.cycle ? p_.cycle : dt;
    const Row du = rate - last;
    const Row aside = T(0.25) * (a * Row(T(h * h)) - du * du / a);
    m.behind = !all((magnitude(du) <= a * Row(h)) & (magnitude(ahead - T(0.5) * h * (last + rate)) <= aside) &
                    (magnitude(ahead) <= h * Row(p_.limits.velocity())));
    if (!m.behind) {
      m.sent = m.q;
      m.command.velocity = m.rate;
      m.command_span = h;
      return {};
    }
    auto motion = within(dt);
    if (dt > p_.cycle && !is_near(Row(motion.displacement))) {
      motion = within(p_.cycle);
      m.command_span = p_.cycle;
    }
    m.sent.add(motion.displacement);
    m.command.velocity = motion.velocity;
    return motion.status;
  }
  /// How far a position command may be from the last one.
  SKINCTL_INLINE bool is_near(const Row& moved) const noexcept {
    return all(magnitude(moved) <= p_.cycle * Row(p_.limits.velocity()));
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
