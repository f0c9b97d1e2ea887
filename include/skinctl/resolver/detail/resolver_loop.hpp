// The loop of the resolver: what resolver.hpp declares.
#pragma once

#include "skinctl/resolver/resolver.hpp"
#include "skinctl/safety/detail/plausible.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_RESOLVER \
  template <Interface I, Model M, Real T, class Integrator, std::size_t History, class Keeper>
#define SKINCTL_RESOLVER_CLASS Resolver<I, M, T, Integrator, History, Keeper>

SKINCTL_RESOLVER
SKINCTL_COLD auto SKINCTL_RESOLVER_CLASS::start(const State<joints, T>& measured) const noexcept -> Memory {
  Memory m;
  if (!detail::is_plausible(measured) || !detail::is_plausible(measured.time)) return m;
  m.started = true;
  m.keeper = keeper_.template start<joints>();
  m.time = measured.time;
  m.measured = measured;
  const T ahead = seconds<T>(p_.delay) + p_.lag;
  Position command = measured.q;
  for (std::size_t i = 0; i < joints; ++i) {
    const T most = p_.limits.velocity()[i];
    const T dq = detail::clamp(measured.dq[i], T(-most), most);
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

SKINCTL_RESOLVER
Interval SKINCTL_RESOLVER_CLASS::interval(const Memory& m, Nanoseconds now) const noexcept {
  Interval out = detail::interval_since(m.started, m.time, now, p_.longest_interval);
  const Nanoseconds steps = (out.to - out.from + p_.substep - 1) / p_.substep;
  out.substeps = steps < Nanoseconds(max_substeps) ? static_cast<unsigned>(steps) : max_substeps;
  return out;
}

SKINCTL_RESOLVER
SKINCTL_INLINE Status SKINCTL_RESOLVER_CLASS::measure(Memory& m, const State<joints, T>& measured,
                                                      Nanoseconds now) const noexcept {
  Status status;
  if (!detail::is_plausible(measured)) {
    status |= Reason::state_not_finite;
  } else if (measured.time < m.measured.time) {
    status |= Reason::time_backwards;
  } else {
    m.measured = measured;
    if (measured.time > now) m.measured.time = now;
  }
  const Position& expected = servo_.predict(m.under_way, m.measured.time);
  m.residual = m.measured.q - expected;
  if constexpr (I == Interface::velocity) m.residual -= m.offset.value;
  if (now - m.measured.time > p_.stale_after) status |= Reason::state_stale;
  return status;
}

SKINCTL_RESOLVER
SKINCTL_INLINE auto SKINCTL_RESOLVER_CLASS::correct(Memory& m, Nanoseconds now, const T& dt) const noexcept
    -> Correction {
  const bool fresh = now - m.measured.time <= p_.fresh_for;
  // An old measurement says nothing about where the robot is now: its difference is not acted on again.
  const Row r = fresh ? Row(m.residual) : Row(T(0)), dead_band = p_.dead_band;
  const Row rho = r - clamp(r, -dead_band, dead_band);
  const auto off = rho != Row(T(0));
  if (fresh) select(off, Row(m.off_for) + dt, T(0)).store(m.off_for);
  const JointAcceleration<joints, T> pull(p_.L2 * rho);
  if constexpr (I == Interface::position) {
    return Correction{Velocity(p_.L1 * rho), pull, any(off), {}};
  } else {
    Correction c{Velocity(p_.L1 * rho + p_.drift * r), pull, any(off), {}};
    for (std::size_t i = 0; i < joints; ++i) {
      // Where the real robot will be when it has carried out all that was sent up to now.
      const T arrives = m.measured.q[i] + (m.sent.value[i] - m.under_way.reached[i]);
      const T brake = p_.limits.acceleration()[i] * braking_share<T>;
      const T reaction = seconds<T>(p_.longest_interval);
      c.speed.most[i] = speed_to_stop(T(p_.limits.upper()[i] - arrives), reaction, brake);
      c.speed.least[i] = -speed_to_stop(T(arrives - p_.limits.lower()[i]), reaction, brake);
    }
    return c;
  }
}

SKINCTL_RESOLVER
SKINCTL_INLINE Status SKINCTL_RESOLVER_CLASS::move(Memory& m, const Correction& c, const Velocity& v1,
                                                   const T& h) const noexcept {
  Status status;
  JointRoom<joints, T> room = p_.limits.room(m.q.value);
  const Row zero = T(0), leash = p_.leash, e = Row(m.q.value) - m.measured.q;
  const Row above = leash - e, below = leash + e;
  const Row most = select(above > zero, above * p_.per_delay, zero);
  const Row least = select(below > zero, -below * p_.per_delay, zero);
  Row v = v1;
  auto leashed = above < room.above;
  if constexpr (I == Interface::position) {
    leashed = leashed | (below < room.below);
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
    if (c.off || !(m.rate == m.v)) {
      const Row corrected = Row(own.velocity) + c.rate;
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
    for (std::size_t i = 0; i < joints; ++i) {
      const T corrected = h * c.rate[i];
      m.offset.add(i, corrected);
      m.q.add(i, motion.displacement[i] + corrected);
      const T near = m.measured.q[i] - p_.leash[i], far = m.measured.q[i] + p_.leash[i];
      const T kept = detail::clamp(m.q.value[i], near, far);
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
  const std::uint64_t by_leash = I == Interface::position && braked != 0 ? leashed.bits() : 0;
  status |= Status::from_bits((own.status | motion.status).bits() & ~Status(Reason::position_limited).bits());
  if ((braked & by_leash) != 0) status |= Reason::lead_limited;
  if ((braked & ~by_leash) != 0) status |= Reason::position_limited;
  return status;
}

/// Velocity towards the real robot that ends there.
SKINCTL_RESOLVER
SKINCTL_COLD auto SKINCTL_RESOLVER_CLASS::way_back(const Memory& m, const T& h) const noexcept -> Velocity {
  Velocity u;
  for (std::size_t i = 0; i < joints; ++i) {
    const T d = m.measured.q[i] - m.q.value[i];
    const T far = d < T(0) ? T(-d) : d;
    const T soft = far / (p_.total_delay + h);
    const T hard = speed_to_stop(far, h, T(T(0.5) * p_.limits.acceleration()[i]));
    const T speed = soft < hard ? soft : hard;
    u[i] = d < T(0) ? T(-speed) : speed;
  }
  return u;
}

SKINCTL_RESOLVER
SKINCTL_INLINE void SKINCTL_RESOLVER_CLASS::choose_mode(Memory& m, const Correction& c,
                                                        bool stale) const noexcept {
  const auto enter = [&](Mode mode) {
    if (m.mode == mode) return;
    m.mode = mode;
    m.mode_for = T(0);
  };
  const bool stuck = c.off && any(Row(m.off_for) >= Row(T(5) * p_.total_delay));
  if (stale) {
    enter(Mode::braking);
  } else if (m.mode != Mode::blocked && stuck) {
    enter(Mode::blocked);
    if constexpr (I == Interface::position) m.v = m.v * T(0);
    for (std::size_t i = 0; i < joints; ++i) m.pushed[i] = c.pull[i] < T(0) ? 1 : (c.pull[i] > T(0) ? -1 : 0);
  } else if (m.mode != Mode::blocked) {
    enter(m.stop ? Mode::braking : Mode::following);
  }
}

/// What the keepers learn of a cycle: the contacts, the measured position, the commands under way.
SKINCTL_RESOLVER
template <class Touch>
SKINCTL_INLINE Status SKINCTL_RESOLVER_CLASS::watch(Memory& m, const Touch& touch,
                                                    const T& dt) const noexcept {
  Status status;
  if constexpr (has_ledger || has_damper) {
    const auto contacts = contacts_of(model_, m.measured.q, touch);
    if constexpr (has_damper)
      if (keeper_.template get<ContactDamper<T>>().observe(m.keeper.template of<ContactDamper<T>>(), contacts,
                                                           m.measured.dq, dt))
        status |= Reason::contact_damped;
    if constexpr (has_ledger)
      keeper_.template get<PortLedger<T>>().book(
          m.keeper.template of<PortLedger<T>>(), contacts, m.measured.q, p_.total_delay / dt, [&](auto&& f) {
            servo_.each_under_way(m.under_way, [&](const Position& q) {
              f(I == Interface::position ? q - m.measured.q : q - m.under_way.reached);
            });
          });
  }
  return status;
}

/// Slows `v` down to what the ledger can pay for, braking included. False if it had to.
SKINCTL_RESOLVER
SKINCTL_INLINE bool SKINCTL_RESOLVER_CLASS::affords(const Memory& m, Velocity& v) const noexcept {
  if constexpr (has_ledger) {
    const auto& ledger = keeper_.template get<PortLedger<T>>();
    const auto& memory = m.keeper.template of<PortLedger<T>>();
    const Position& from = I == Interface::position ? m.measured.q : m.under_way.reached;
    const Position& sent = I == Interface::position ? m.q.value : m.sent.value;
    const T ahead = p_.lead + seconds<T>(p_.period);
    const auto allows = [&](const T& share) {
      Position dq;
      for (std::size_t i = 0; i < joints; ++i) {
        const T u = share * v[i], speed = u < T(0) ? T(-u) : u;
        dq[i] = sent[i] - from[i] + u * (ahead + T(0.5) * speed / p_.limits.acceleration()[i]);
      }
      return ledger.allows(memory, dq, v);
    };
    if (allows(T(1))) [[likely]]
      return true;
    T share(0), part(0.5);
    for (int k = 0; k < 6; ++k, part = T(0.5) * part)
      if (allows(share + part)) share = share + part;
    v = share * v;
    return false;
  } else {
    return true;
  }
}

// One function for the sub-steps and for a blocked robot: the law is the largest part of a cycle's code.
SKINCTL_RESOLVER
template <class L, class Touch>
SKINCTL_NOINLINE auto SKINCTL_RESOLVER_CLASS::drive(Memory& m, const L& law,
                                                    const typename L::Memory& law_memory,
                                                    const State<joints, T>& state,
                                                    const JointAcceleration<joints, T>& pull, const T& h,
                                                    const Touch& touch) const noexcept -> Driven<L> {
  const Knows<L, Touch> known(model_, state, h, touch);
  Driven<L> out([&]() SKINCTL_INLINE_LAMBDA { return evaluate(law, law_memory, known, h); });
  if (!detail::is_finite(out.law.torque)) [[unlikely]] {
    out.status |= Reason::torque_not_finite;
    return out;
  }
  out.torque = p_.limits.within(out.law.torque, state.dq);
  if (any(Row(out.torque) != out.law.torque)) out.status |= Reason::torque_limited;
  const ContactDamping<joints, T>* damping = nullptr;
  if constexpr (has_damper) {
    const auto& d = m.keeper.template of<ContactDamper<T>>().damping;
    if (d.any) damping = &d;
  }
  const auto next =
      detail::step_velocity<Integrator>(known, p_.shape, p_.has_coulomb, out.torque, pull, m.last, damping);
  if (next.singular) out.status |= Reason::singular;
  out.velocity = next.velocity;
  if constexpr (has_tank) {
    const auto& tank = keeper_.template get<EnergyTank<T>>();
    auto& memory = m.keeper.template of<EnergyTank<T>>();
    MassMatrix<joints, T> mass = known.mass();
    for (std::size_t i = 0; i < joints; ++i) mass(i, i) = mass(i, i) + p_.shape.inertia[i];
    tank.charge(memory, mass, state.dq);
    const Torque port = skin_torque(model_, known.angles(), touch);
    const Torque passive = tank.settings().port_gain * port + known.gravity();
    const T share = tank.pay(memory, port, out.torque - passive, state.dq, out.velocity, h, [&] {
      return detail::step_velocity<Integrator>(known, p_.shape, p_.has_coulomb, passive, {}, m.last, damping)
          .velocity;
    });
    if (share < T(1)) {
      out.status |= Reason::tank_empty;
      out.torque = passive + share * (out.torque - passive);
    }
  }
  return out;
}

/// Whether a blocked robot may follow again, given what its laws would ask of it at rest.
SKINCTL_RESOLVER
SKINCTL_COLD void SKINCTL_RESOLVER_CLASS::try_to_leave(Memory& m, const Correction& c,
                                                       const Torque& torque) const noexcept {
  const Torque net = torque - gravity_torque(model_, m.q.value);
  bool here = true;
  T push(0), scale(0);
  for (std::size_t i = 0; i < joints; ++i) {
    const T e = m.q.value[i] - m.measured.q[i];
    here &= e <= p_.dead_band[i] && -e <= p_.dead_band[i];
    push = push + T(m.pushed[i]) * net[i];
    scale = scale + p_.limits.torque()[i];
  }
  const bool released = !(push > T(1e-4) * scale);
  if (here && !c.off && m.mode_for >= p_.total_delay && (released || m.mode_for >= p_.retry)) {
    m.mode = Mode::following;
    m.mode_for = T(0);
  }
}

SKINCTL_RESOLVER
SKINCTL_INLINE Status SKINCTL_RESOLVER_CLASS::publish(Memory& m, const Correction& c, const Velocity& before,
                                                      const Torque& torque, const T& dt) const noexcept {
  Status status;
  auto& command = m.command;
  const Row last = command.velocity;
  if (I == Interface::position && p_.lead == T(0)) {
    m.sent = m.q;
    command.velocity = m.rate;
  } else {
    // What is sent follows the virtual robot's position, `lead` seconds ahead, within the same limits.
    const T per_dt = T(1) / dt;
    auto room = p_.limits.room(m.sent.value);
    const Row rate = m.rate, sent = m.sent.value, steady = rate + p_.lead * (rate - before) * per_dt;
    Row target;
    if constexpr (I == Interface::position) {
      const Row goal = m.q.value + p_.lead * rate, e = sent - m.measured.q, leash = p_.leash;
      target = steady + (goal - sent) * per_dt - T(0.5) * (last + steady);
      smaller(room.above, leash - e).store(room.above);
      smaller(room.below, leash + e).store(room.below);
    } else {
      // A velocity is held for a period: half of it is still to come.
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

SKINCTL_RESOLVER
template <class L, class Touch>
SKINCTL_INLINE auto SKINCTL_RESOLVER_CLASS::step(Memory& m, const L& law, typename L::Memory& law_memory,
                                                 const State<joints, T>& measured, const Interval& interval,
                                                 std::span<const Touch> touches) const noexcept
    -> Resolved<joints, T, terms_of<L>> {
  if (!m.started || interval.substeps == 0) [[unlikely]]
    return {m.command, interval.status, {}, {}};
  SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
  const T dt = seconds<T>(interval.to - interval.from);
  const Velocity before = m.rate;
  Status status = interval.status;
  std::array<Torque, terms_of<L>> shares{};
  if constexpr (I == Interface::velocity) {
    // The velocity that was sent has been held up to now.
    for (std::size_t i = 0; i < joints; ++i)
      m.sent.add(i, m.command.velocity[i] * seconds<T>(interval.to - m.command.time));
  }
  status |= measure(m, measured, interval.to);
  const Correction c = correct(m, interval.to, dt);
  m.mode_for = m.mode_for + dt;
  choose_mode(m, c, status.has(Reason::state_stale));
  status |= watch(m, touches[interval.substeps - 1], dt);

  Torque torque = m.command.torque;
  for (unsigned j = 0; j < interval.substeps; ++j) {
    const T h = seconds<T>(interval.at(j + 1) - interval.at(j));
    Velocity v1;
    Correction moved = c;
    if (m.mode == Mode::following) {
      const auto driven = drive(m, law, law_memory, {interval.at(j), m.q.value, m.v}, c.pull, h, touches[j]);
      status |= driven.status;
      torque = driven.torque;
      v1 = driven.velocity;
      if (!affords(m, v1)) [[unlikely]]
        status |= Reason::energy_held;
      if (!driven.status.has(Reason::torque_not_finite)) [[likely]] {
        law_memory = driven.law.memory;
        shares = driven.law.shares;
      }
    } else {
      moved.rate = m.mode == Mode::blocked ? way_back(m, h) : Velocity{};
      moved.off = true;
    }
    const Position from = m.q.value;
    status |= move(m, moved, v1, h);
    if constexpr (has_tank)
      keeper_.template get<EnergyTank<T>>().book(m.keeper.template of<EnergyTank<T>>(), m.q.value - from,
                                                 p_.shape, h);
  }
  m.time = interval.to;
  if (m.mode == Mode::blocked) {
    status |= Reason::blocked;
    if (!m.stop) {
      const auto driven = drive(m, law, law_memory, {m.time, m.q.value, Velocity{}}, {},
                                seconds<T>(p_.period), touches[interval.substeps - 1]);
      if (!driven.status.has(Reason::torque_not_finite)) {
        torque = driven.torque;
        try_to_leave(m, c, torque);
      }
    }
  }
  if (m.stop) status |= Reason::stopping;
  if (!p_.limits.hold(m.q.value)) status |= Reason::outside_limits;
  status |= publish(m, c, before, torque, dt);
  return {m.command, status, shares, {}};
}

SKINCTL_RESOLVER
SKINCTL_INLINE void SKINCTL_RESOLVER_CLASS::sent(Memory& m,
                                                 const JointCommand<joints, T>& command) const noexcept {
  if (!m.started || !command.valid) return;
  m.command = command;
  m.command.time = m.time;
  m.rate = m.v = command.velocity;
  m.last = {};
  const T ahead = p_.lead - (I == Interface::velocity ? T(0.5) * seconds<T>(p_.period) : T(0));
  for (std::size_t i = 0; i < joints; ++i) {
    if constexpr (I == Interface::position) m.sent.set(i, command.position[i]);
    m.q.set(i, m.sent.value[i] + m.offset.value[i] - ahead * m.v[i]);
  }
  servo_.correct(m.under_way, m.sent.value, I == Interface::velocity ? command.velocity : Velocity{});
}

#undef SKINCTL_RESOLVER
#undef SKINCTL_RESOLVER_CLASS

SKINCTL_END_NAMESPACE
