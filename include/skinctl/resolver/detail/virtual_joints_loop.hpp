// The loop of a virtual robot's joints, declared in virtual_joints.hpp.
#pragma once

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/resolver/detail/virtual_joints.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
#define SKINCTL_VIRTUAL_JOINTS template <Interface I, std::size_t N, Real T, std::size_t History>
#define SKINCTL_VIRTUAL_JOINTS_CLASS VirtualJoints<I, N, T, History>

SKINCTL_VIRTUAL_JOINTS
SKINCTL_COLD auto SKINCTL_VIRTUAL_JOINTS_CLASS::start(const State<N, T>& measured) const noexcept -> Memory {
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
    if (dq * p_.total_delay > p_.dead_band[i] || -dq * p_.total_delay > p_.dead_band[i]) {
      m.v[i] = dq;
      command[i] = measured.q[i] + dq * ahead;
    }
    m.q.set(i, command[i] - p_.lead * m.v[i]);
    m.sent.set(i, command[i]);
  }
  m.rate = m.v;
  m.under_way = servo_.start(measured.time, measured.q, m.v);
  m.command.time = m.time;
  m.command.position = command;
  m.command.velocity = m.v;
  m.command.valid = true;
  return m;
}

SKINCTL_VIRTUAL_JOINTS
Interval SKINCTL_VIRTUAL_JOINTS_CLASS::interval(const Memory& m, Nanoseconds now) const noexcept {
  Interval out = interval_since(m.started, m.time, now, p_.longest_interval);
  const std::int64_t steps = (out.to - out.from + p_.substep - 1ns) / p_.substep;
  out.substeps = steps < std::int64_t(max_substeps) ? static_cast<unsigned>(steps) : max_substeps;
  return out;
}

SKINCTL_VIRTUAL_JOINTS
template <class Check>
SKINCTL_INLINE auto SKINCTL_VIRTUAL_JOINTS_CLASS::begin(Memory& m, const State<N, T>& measured,
                                                        const Interval& interval,
                                                        const Check& check) const noexcept -> Begun {
  const T dt = seconds<T>(interval.to - interval.from);
  const Velocity before = m.rate;
  if constexpr (I == Interface::velocity) {
    // The velocity that was sent has been held up to now.
    for (std::size_t i = 0; i < N; ++i)
      m.sent.add(i, m.command.velocity[i] * seconds<T>(interval.to - m.command.time));
  }
  const Status status = interval.status | measure(m, measured, interval.to, check);
  const Begun out{correct(m, interval.to, dt), before, dt, status};
  m.mode_for = m.mode_for + dt;
  choose_mode(m, out.correction, status.has(Reason::state_stale));
  return out;
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE Status SKINCTL_VIRTUAL_JOINTS_CLASS::move(Memory& m, const Correction& c, const Velocity& v1,
                                                         const T& h) const noexcept {
  const bool follows = m.mode == ResolverMode::following;
  Velocity back;
  if (m.mode == ResolverMode::blocked) [[unlikely]]
    back = way_back(m, h);
  return shift(m, c, follows ? c.rate : back, c.off || !follows, v1, h);
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE Status SKINCTL_VIRTUAL_JOINTS_CLASS::end(Memory& m, const Begun& begun,
                                                        const Torque& torque) const noexcept {
  Status status;
  if (m.mode == ResolverMode::blocked) status |= Reason::blocked;
  if (m.stop) status |= Reason::stopping;
  if (!p_.limits.hold(m.q.value)) status |= Reason::outside_limits;
  return status | publish(m, begun.correction, begun.before, torque, begun.dt);
}

SKINCTL_VIRTUAL_JOINTS
template <class Check>
SKINCTL_INLINE Status SKINCTL_VIRTUAL_JOINTS_CLASS::measure(Memory& m, const State<N, T>& measured,
                                                            Nanoseconds now,
                                                            const Check& check) const noexcept {
  Status status = take_measurement(m.measured, measured, now, check);
  const Position& expected = servo_.predict(m.under_way, m.measured.time);
  m.residual = m.measured.q - expected;
  if constexpr (I == Interface::velocity) m.residual -= m.offset.value;
  if (now - m.measured.time > p_.stale_after) status |= Reason::state_stale;
  return status;
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE auto SKINCTL_VIRTUAL_JOINTS_CLASS::correct(Memory& m, Nanoseconds now,
                                                          const T& dt) const noexcept -> Correction {
  const bool fresh = now - m.measured.time <= p_.fresh_for;
  // An old measurement does not show the present position of the robot: its residual is not used again.
  const Row r = fresh ? Row(m.residual) : Row(T(0)), dead_band = p_.dead_band;
  const Row rho = r - clamp(r, -dead_band, dead_band);
  const auto off = rho != Row(T(0));
  if (fresh) select(off, Row(m.off_for) + dt, T(0)).store(m.off_for);
  const JointAcceleration<N, T> pull(p_.L2 * rho);
  if constexpr (I == Interface::position) {
    return Correction{Velocity(p_.L1 * rho), pull, any(off), {}};
  } else {
    Correction c{Velocity(p_.L1 * rho + p_.drift * r), pull, any(off), {}};
    for (std::size_t i = 0; i < N; ++i) {
      // Position of the real robot when it has carried out all commands sent up to now.
      const T arrives = m.measured.q[i] + (m.sent.value[i] - m.under_way.reached[i]);
      const T brake = p_.limits.acceleration()[i] * braking_share<T>;
      const T reaction = seconds<T>(p_.longest_interval);
      c.speed.most[i] = speed_to_stop(T(p_.limits.upper()[i] - arrives), reaction, brake);
      c.speed.least[i] = -speed_to_stop(T(arrives - p_.limits.lower()[i]), reaction, brake);
    }
    return c;
  }
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE Status SKINCTL_VIRTUAL_JOINTS_CLASS::shift(Memory& m, const Correction& c,
                                                          const Velocity& rate, bool off, const Velocity& v1,
                                                          const T& h) const noexcept {
  Status status;
  JointRoom<N, T> room = p_.limits.room(m.q.value);
  const Row zero = T(0), max_lead = p_.max_lead, e = Row(m.q.value) - m.measured.q;
  const Row above = max_lead - e, below = max_lead + e;
  const Row most = select(above > zero, above * p_.per_delay, zero);
  const Row least = select(below > zero, -below * p_.per_delay, zero);
  Row v = v1;
  auto by_lead = above < room.above;
  if constexpr (I == Interface::position) {
    by_lead = by_lead | (below < room.below);
    smaller(room.above, above).store(room.above);
    smaller(room.below, below).store(room.below);
  } else {
    room.above = room.below = Position::constant(std::numeric_limits<T>::infinity());
    if (any((v > c.speed.most) | (v < c.speed.least))) status |= Reason::position_limited;
    v = clamp(v, c.speed.least, c.speed.most);
  }
  if (any((v > most) | (v < least))) status |= Reason::lead_limited;
  const auto own = p_.limits.move(room, m.v, Velocity(clamp(v, least, most)), h);
  auto motion = own;
  if constexpr (I == Interface::position) {
    if (off || !(m.rate == m.v)) {
      const Row corrected = Row(own.velocity) + rate;
      motion = p_.limits.move(room, m.rate, Velocity(clamp(corrected, least, most)), h);
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
  ((Row(own.velocity) - m.v) * T(T(1) / h)).store(m.last);
  m.v = own.velocity;
  m.rate = motion.velocity;
  const std::uint64_t braked = own.braked | motion.braked;
  const std::uint64_t lead_acts = I == Interface::position && braked != 0 ? by_lead.bits() : 0;
  status |= Status::from_bits((own.status | motion.status).bits() & ~Status(Reason::position_limited).bits());
  if ((braked & lead_acts) != 0) status |= Reason::lead_limited;
  if ((braked & ~lead_acts) != 0) status |= Reason::position_limited;
  return status;
}

/// Velocity towards the real robot that ends there at rest.
SKINCTL_VIRTUAL_JOINTS
SKINCTL_COLD auto SKINCTL_VIRTUAL_JOINTS_CLASS::way_back(const Memory& m, const T& h) const noexcept
    -> Velocity {
  Velocity u;
  for (std::size_t i = 0; i < N; ++i) {
    const T d = m.measured.q[i] - m.q.value[i];
    const T far = d < T(0) ? T(-d) : d;
    const T soft = far / (p_.total_delay + h);
    const T hard = speed_to_stop(far, h, T(T(0.5) * p_.limits.acceleration()[i]));
    const T speed = soft < hard ? soft : hard;
    u[i] = d < T(0) ? T(-speed) : speed;
  }
  return u;
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE void SKINCTL_VIRTUAL_JOINTS_CLASS::choose_mode(Memory& m, const Correction& c,
                                                              bool stale) const noexcept {
  const auto enter = [&](ResolverMode mode) {
    if (m.mode == mode) return;
    m.mode = mode;
    m.mode_for = T(0);
  };
  const bool stuck = c.off && any(Row(m.off_for) >= Row(T(5) * p_.total_delay));
  if (stale) {
    enter(ResolverMode::braking);
  } else if (m.mode != ResolverMode::blocked && stuck) {
    enter(ResolverMode::blocked);
    if constexpr (I == Interface::position) m.v = m.v * T(0);
    for (std::size_t i = 0; i < N; ++i) m.pushed[i] = c.pull[i] < T(0) ? 1 : (c.pull[i] > T(0) ? -1 : 0);
  } else if (m.mode != ResolverMode::blocked) {
    enter(m.stop ? ResolverMode::braking : ResolverMode::following);
  }
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_COLD void SKINCTL_VIRTUAL_JOINTS_CLASS::try_to_leave(Memory& m, const Correction& c,
                                                             const Torque& net) const noexcept {
  bool here = true;
  T push(0), scale(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T e = m.q.value[i] - m.measured.q[i];
    here &= e <= p_.dead_band[i] && -e <= p_.dead_band[i];
    push = push + T(m.pushed[i]) * net[i];
    scale = scale + p_.limits.torque()[i];
  }
  const bool released = !(push > T(1e-4) * scale);
  if (here && !c.off && m.mode_for >= p_.total_delay && (released || m.mode_for >= p_.retry)) {
    m.mode = ResolverMode::following;
    m.mode_for = T(0);
  }
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE Status SKINCTL_VIRTUAL_JOINTS_CLASS::publish(Memory& m, const Correction& c,
                                                            const Velocity& before, const Torque& torque,
                                                            const T& dt) const noexcept {
  Status status;
  auto& command = m.command;
  const Row last = command.velocity;
  if (I == Interface::position && p_.lead == T(0)) {
    m.sent = m.q;
    command.velocity = m.rate;
  } else {
    // The command follows the virtual robot's position, `lead` seconds ahead, within the same limits.
    const T per_dt = T(1) / dt;
    auto room = p_.limits.room(m.sent.value);
    const Row rate = m.rate, sent = m.sent.value, steady = rate + p_.lead * (rate - before) * per_dt;
    Row target;
    if constexpr (I == Interface::position) {
      const Row goal = m.q.value + p_.lead * rate, e = sent - m.measured.q, max_lead = p_.max_lead;
      target = steady + (goal - sent) * per_dt - T(0.5) * (last + steady);
      smaller(room.above, max_lead - e).store(room.above);
      smaller(room.below, max_lead + e).store(room.below);
    } else {
      // A velocity is held for a period, half of which is still to come.
      const Row goal = m.q.value + T(p_.lead - T(0.5) * seconds<T>(p_.period)) * rate;
      target = clamp(steady + p_.catch_up * (goal - sent - m.offset.value), c.speed.least, c.speed.most);
      room.above = room.below = Position::constant(std::numeric_limits<T>::infinity());
    }
    const auto motion = p_.limits.move(room, Velocity(last), Velocity(target), dt);
    status = motion.status;
    command.velocity = motion.velocity;
    if constexpr (I == Interface::position) m.sent.add(motion.displacement);
  }
  command.time = m.time;
  command.position = I == Interface::position ? m.sent.value : m.q.value;
  ((Row(command.velocity) - last) / Row(dt)).store(command.acceleration);
  command.torque = torque;
  command.valid = true;
  servo_.send(m.under_way, m.time, m.sent.value, I == Interface::velocity ? command.velocity : Velocity{});
  return status;
}

SKINCTL_VIRTUAL_JOINTS
SKINCTL_INLINE void SKINCTL_VIRTUAL_JOINTS_CLASS::sent(Memory& m,
                                                       const JointCommand<N, T>& command) const noexcept {
  if (!m.started || !command.valid) return;
  m.command = command;
  m.command.time = m.time;
  m.rate = m.v = command.velocity;
  m.last = {};
  const T ahead = p_.lead - (I == Interface::velocity ? T(0.5) * seconds<T>(p_.period) : T(0));
  for (std::size_t i = 0; i < N; ++i) {
    if constexpr (I == Interface::position) m.sent.set(i, command.position[i]);
    m.q.set(i, m.sent.value[i] + m.offset.value[i] - ahead * m.v[i]);
  }
  servo_.correct(m.under_way, m.sent.value, I == Interface::velocity ? command.velocity : Velocity{});
}

#undef SKINCTL_VIRTUAL_JOINTS
#undef SKINCTL_VIRTUAL_JOINTS_CLASS

}  // namespace detail
SKINCTL_END_NAMESPACE
