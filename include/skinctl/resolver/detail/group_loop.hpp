// One cycle of a resolver for groups of joints, declared in group_resolver.hpp.
#pragma once

#include "skinctl/resolver/group_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_GROUPS \
  template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class Keeper, class Tool>
#define SKINCTL_GROUPS_CLASS GroupResolver<M, T, Sets, Integrator, History, Keeper, Tool>

SKINCTL_GROUPS
template <class... S, class... D>
SKINCTL_COLD SKINCTL_GROUPS_CLASS::GroupResolver(const M& model, const std::tuple<S...>& stiff,
                                                 const std::tuple<D...>& driven, const Keeper& keeper,
                                                 const Tool& tool)
    : model_(model),
      virtual_(virtual_of(stiff)),
      limits_(limits_of_all(std::tuple_cat(stiff, driven))),
      keeper_(keeper),
      tool_(tool) {
  shape_.damping = std::get<0>(stiff).configuration.virtual_damping;
  torque_rate_ = std::get<0>(stiff).configuration.torque_rate;
  const auto take = [&](const auto& g) {
    using Given = std::remove_cvref_t<decltype(g)>;
    using Set = JointSubset<joints, Given::set>;
    const auto& c = g.configuration;
    Set::put(c.viscous_friction, shape_.viscous);
    Set::put(c.coulomb_friction, shape_.coulomb);
    Set::put(c.virtual_inertia, shape_.inertia);
    const auto number = [](const T& x) { return static_cast<double>(x); };
    if constexpr (Given::interface == Interface::torque) {
      for (std::size_t i = 0; i < Given::count; ++i) {
        has_friction_ = has_friction_ || c.viscous_friction[i] > T(0);
        require(c.coulomb_friction[i] == T(0), "Coulomb friction", number(c.coulomb_friction[i]),
                "0 for joints by torque");
        require(c.virtual_inertia[i] == T(0), "virtual inertia", number(c.virtual_inertia[i]),
                "0 for joints by torque");
      }
      require(c.virtual_damping == T(0), "virtual damping", number(c.virtual_damping),
              "0 for joints by torque");
      driven_torque_rate_ = c.torque_rate;
      stale_after_ = c.stale_after.value_or(5 * c.total_delay());
    } else {
      for (const T& x : c.coulomb_friction) has_coulomb_ = has_coulomb_ || x > T(0);
      require(c.virtual_damping == shape_.damping, "virtual damping of a group", number(c.virtual_damping),
              "that of the other groups: one virtual robot");
      require(c.torque_rate == torque_rate_, "torque rate of a group", number(c.torque_rate),
              "that of the other groups: one law");
    }
  };
  std::apply([&](const auto&... g) { (take(g), ...); }, std::tuple_cat(stiff, driven));
  stiff_shape_ = {Stiff::of(shape_.viscous), Stiff::of(shape_.coulomb), Stiff::of(shape_.inertia),
                  shape_.damping};
}

SKINCTL_GROUPS
template <class Given>
SKINCTL_COLD auto SKINCTL_GROUPS_CLASS::limits_of_all(const Given& groups) -> JointLimits<joints, T> {
  typename JointLimits<joints, T>::Values all;
  const auto take = [&](const auto& g) {
    using Set = JointSubset<joints, std::remove_cvref_t<decltype(g)>::set>;
    const auto& v = g.configuration.limits.values();
    Set::put(v.lower, all.lower);
    Set::put(v.upper, all.upper);
    Set::put(v.velocity, all.velocity);
    Set::put(v.acceleration, all.acceleration);
    Set::put(v.torque, all.torque);
    Set::put(v.power, all.power);
  };
  std::apply([&](const auto&... g) { (take(g), ...); }, groups);
  return JointLimits<joints, T>(all);
}

SKINCTL_GROUPS
SKINCTL_COLD auto SKINCTL_GROUPS_CLASS::start(const State<joints, T>& measured) const noexcept -> Memory {
  Memory m;
  if (!detail::is_plausible(measured)) return m;
  m.keeper = keeper_.template start<joints>();
  m.started = true;
  each([&](auto k) {
    auto& group = m.template group<k.value>();
    group = std::get<k.value>(virtual_).start(part_of<Part<k.value>>(measured));
    m.started = m.started && group.started;
  });
  m.measured = measured;
  if (!m.started) return m;
  const Torque torque = held(measured);
  if constexpr (has_driven) {
    m.driven.torque = Driven::of(torque);
    if constexpr (has_tank)
      m.driven.tank = keeper_.template get<EnergyTank<T>>().template hold<Driven::count>();
  }
  compose(m, torque);
  return m;
}

/// The inputs of the passivity parts in a cycle. The observer watches over the stiff joints: a contact's motion
/// by the driven ones is not ahead of the measurement.
SKINCTL_GROUPS
template <class Pressed>
SKINCTL_INLINE Status SKINCTL_GROUPS_CLASS::watch(Memory& m, const Pressed& pressed,
                                                  const T& dt) const noexcept {
  Status status;
  if constexpr (watches_contacts) {
    auto contacts = contacts_of(model_, m.measured.q, pressed);
    if constexpr (has_damper)
      if (keeper_.template get<ContactDamper<T>>().observe(m.keeper.template of<ContactDamper<T>>(), contacts,
                                                           m.measured.dq, dt))
        status |= Reason::contact_damped;
    if constexpr (has_passivity_observer) {
      if constexpr (has_driven)
        for (std::size_t k = 0; k < contacts.count; ++k)
          for (const std::size_t i : Driven::index) contacts.list[k].row[i] = T(0);
      T slowest(0);
      each([&](auto k) {
        const T total = parameters<k.value>().total_delay;
        if (total > slowest) slowest = total;
      });
      keeper_.template get<PassivityObserver<T>>().book(
          m.keeper.template of<PassivityObserver<T>>(), contacts, m.measured.q, slowest / dt, [&](auto&& f) {
            each([&](auto k) {
              constexpr bool here = Group<k.value>::interface == Interface::position;
              const auto& group = m.template group<k.value>();
              std::get<k.value>(virtual_).servo().each_under_way(group.under_way, [&](const auto& q) {
                Position way;
                // The other groups' furthest command is their last one.
                each([&](auto other) {
                  const auto& o = m.template group<other.value>();
                  constexpr bool by_position = Group<other.value>::interface == Interface::position;
                  Part<other.value>::put(o.sent.value - (by_position ? o.measured.q : o.under_way.reached),
                                         way);
                });
                Part<k.value>::put(q - (here ? group.measured.q : group.under_way.reached), way);
                f(way);
              });
            });
          });
    }
  }
  return status;
}

SKINCTL_GROUPS
SKINCTL_INLINE bool SKINCTL_GROUPS_CLASS::affords(const Memory& m, Velocity& v) const noexcept {
  if constexpr (has_passivity_observer) {
    return detail::slow_to_afford(
        keeper_.template get<PassivityObserver<T>>(), m.keeper.template of<PassivityObserver<T>>(), v,
        [&](const Velocity& u) {
          Position dq;
          each([&](auto k) {
            const auto& group = m.template group<k.value>();
            const auto& p = parameters<k.value>();
            constexpr bool by_position = Group<k.value>::interface == Interface::position;
            const T ahead = p.lead + p.cycle;
            for (std::size_t j = 0; j < Group<k.value>::count; ++j) {
              const std::size_t i = Part<k.value>::index[j];
              const T speed = u[i] < T(0) ? T(-u[i]) : u[i];
              const T from = by_position ? group.measured.q[j] : group.under_way.reached[j];
              const T sent = by_position ? group.q.value[j] : group.sent.value[j];
              dq[i] = sent - from + u[i] * (ahead + T(0.5) * speed / p.limits.acceleration()[j]);
            }
          });
          return dq;
        });
  } else {
    return true;
  }
}

SKINCTL_GROUPS
template <class L, class Touch>
SKINCTL_NOINLINE auto SKINCTL_GROUPS_CLASS::drive(Memory& m, const L& law,
                                                  const typename L::Memory& law_memory,
                                                  const State<joints, T>& now, const Acceleration& pull,
                                                  const Acceleration& swing, const T& h,
                                                  const Touch& touch) const noexcept -> Moved<L> {
  const auto& total = total_of(touch);
  const Knows<L, LawTouch<Touch>> known = this->template known<L>(now, h, total);
  Moved<L> out([&]() SKINCTL_INLINE_LAMBDA { return evaluate(law, law_memory, known, h); });
  if (!detail::is_finite(out.law.torque)) [[unlikely]] {
    out.status |= Reason::torque_not_finite;
    return out;
  }
  StiffTorque asked = Stiff::of(out.law.torque);
  const StiffTorque step = T(torque_rate_ * h) * Stiff::of(limits_.torque());
  if (m.own.template bound<L, Stiff>(out.law.shares, step, asked)) [[unlikely]]
    out.status |= Reason::torque_limited;
  Stiff::put(asked, out.torque);
  Velocity v;
  Stiff::put(Stiff::of(now.dq), v);
  const Torque within = limits_.within(out.torque, v);
  if (!(within == out.torque)) out.status |= Reason::torque_limited;
  out.torque = within;
  const ContactDamping<joints, T>* damping = nullptr;
  if constexpr (has_damper) {
    const auto& d = m.keeper.template of<ContactDamper<T>>().damping;
    if (d.any) damping = &d;
  }
  const auto moved = [&](const Torque& tau, const Acceleration& by) {
    return detail::step_velocity_of<Integrator, Stiff>(known, stiff_shape_, has_coulomb_, Stiff::of(tau),
                                                       Stiff::of(by), Stiff::of(last(m)), damping, tool_,
                                                       &swing);
  };
  const auto next = moved(out.torque, pull);
  if (next.singular) out.status |= Reason::singular;
  Stiff::put(next.velocity, out.velocity);
  if constexpr (has_tank) {
    const auto& tank = keeper_.template get<EnergyTank<T>>();
    auto& memory = m.keeper.template of<EnergyTank<T>>();
    tank.charge(memory, known.mass(), v);
    const auto stiff_only = [](const Torque& tau) {
      Torque part;
      Stiff::put(Stiff::of(tau), part);
      return part;
    };
    const Torque port = stiff_only(skin_torque(model_, known.angles(), contact_part(touch)));
    const Torque passive = tank.settings().port_gain * port + stiff_only(known.gravity());
    const T share = tank.pay(memory, port, out.torque - passive, v, out.velocity, h, [&] {
      Velocity without;
      Stiff::put(moved(passive, {}).velocity, without);
      return without;
    });
    if (share < T(1)) {
      out.status |= Reason::tank_empty;
      out.torque = passive + share * (out.torque - passive);
    }
    if constexpr (has_driven) {
      // The recoil of the driven joints is a port as a contact is.
      Torque recoil =
          coriolis_torque(model_, known.angles(), v) - coriolis_torque(model_, known.angles(), now.dq);
      for (const std::size_t i : Stiff::index)
        for (const std::size_t j : Driven::index) recoil[i] = recoil[i] - known.mass()(i, j) * swing[j];
      memory.port += stiff_only(recoil);
    }
  }
  return out;
}

SKINCTL_GROUPS
template <class L, class Touch>
SKINCTL_NOINLINE Status SKINCTL_GROUPS_CLASS::turn(Memory& m, const L& law,
                                                   const typename L::Memory& law_memory,
                                                   const State<joints, T>& now, const Touch& touch,
                                                   const T& dt, Torque& asked,
                                                   DrivenTorque& driven) const noexcept {
  const auto& total = total_of(touch);
  const Knows<L, LawTouch<Touch>> known = this->template known<L>(now, seconds<T>(period()), total);
  Status status;
  if constexpr (has_driven && detail::tracks<L, terms_of<L>>) {
    const auto evaluation = evaluate(law, law_memory, known, seconds<T>(period()));
    asked = evaluation.torque;
    if (!detail::is_finite(asked)) return Reason::torque_not_finite;
    driven = Driven::of(asked);
    const DrivenTorque step = T(driven_torque_rate_ * dt) * Driven::of(limits_.torque());
    if (m.driven.own.template bound<L, Driven>(evaluation.shares, step, driven)) [[unlikely]]
      status |= Reason::torque_limited;
  } else {
    asked = torque_of(law, law_memory, known);
    if (!detail::is_finite(asked)) return Reason::torque_not_finite;
    if constexpr (has_driven) driven = Driven::of(asked);
  }
  return status;
}

/// Scales the active part of the driven joints' torque down to the share that the tank pays for. Their motion
/// is predicted for stiff joints that move steadily; what it was is booked in the next cycle.
SKINCTL_GROUPS
SKINCTL_INLINE Status SKINCTL_GROUPS_CLASS::pay(Memory& m, const DrivenTorque& passive,
                                                const DrivenTorque& gravity,
                                                DrivenTorque& torque) const noexcept {
  const auto& tank = keeper_.template get<EnergyTank<T>>();
  auto& held_tank = m.driven.tank;
  held_tank.energy = m.keeper.template of<EnergyTank<T>>().energy;
  Torque whole;
  Driven::put(torque, whole);
  const DrivenTorque active = Driven::of(limits_.within(whole, m.measured.dq)) - passive;
  const JointAngles<M, T> angles(model_, m.measured.q);
  const DrivenTorque bias = gravity + Driven::of(coriolis_torque(model_, angles, m.measured.dq));
  const math::Ldlt<Driven::count, T> mass(block_of<Driven>(mass_matrix(model_, angles)).data);
  const auto v = Driven::of(m.measured.dq);
  const T h = seconds<T>(period());
  const T share = tank.pay(held_tank, passive, active, v, h, [&](const DrivenTorque& tau) {
    const DrivenTorque net = tau - bias;
    JointAcceleration<Driven::count, T> given;
    if (mass.positive_definite()) mass.solve(net.data, given.data);
    return integrate(v, given, h);
  });
  if (!(share < T(1))) return {};
  torque = passive + share * active;
  return Reason::tank_empty;
}

SKINCTL_GROUPS
template <class L, class Touch, class Check, class Pressed>
auto SKINCTL_GROUPS_CLASS::step(Memory& m, const L& law, typename L::Memory& law_memory,
                                const State<joints, T>& measured, const Interval& interval,
                                std::span<const Touch> touches, const Check& check,
                                const Pressed& pressed) const noexcept -> Resolved<joints, T, terms_of<L>> {
  Resolved<joints, T, terms_of<L>> out{m.command, interval.status, {}, {}};
  if (!m.started) return out;
  if (interval.substeps == 0) {
    each([&](auto k) { m.template group<k.value>().odd = detail::odd_time_of(interval); });
    // Even if the clock is wrong, gravity is compensated at the measured position.
    out.fallback = held(detail::believed(measured, m.measured, check));
    return out;
  }
  SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
  const Touch& newest = touches[interval.substeps - 1];
  const T dt = seconds<T>(interval.to - interval.from);
  const State<joints, T> before = m.measured;
  out.status |= take_measurement(m.measured, measured, interval.to, check);
  auto begun = [&]<std::size_t... K>(std::index_sequence<K...>) {
    return std::tuple{
        std::get<K>(virtual_).begin(m.template group<K>(), part_of<Part<K>>(m.measured), interval)...};
  }(std::make_index_sequence<stiff_groups>{});
  Acceleration pull, swing;
  Status found;
  each([&](auto k) {
    found |= std::get<k.value>(begun).status;
    Part<k.value>::put(std::get<k.value>(begun).correction.pull, pull);
  });
  if (interval.to - m.measured.time > stale_after_ && has_driven) found |= Reason::state_stale;
  out.status |= found;
  for (const std::size_t i : Driven::index) swing[i] = (m.measured.dq[i] - before.dq[i]) / dt;
  if constexpr (std::is_same_v<Pressed, PressedUnknown>) {
    out.status |= watch(m, contact_part(newest), dt);
  } else {
    out.status |= watch(m, pressed, dt);
  }
  [[maybe_unused]] Torque gravity, port;
  if constexpr (has_driven) gravity = gravity_torque(model_, m.measured.q);
  if constexpr (has_tank && has_driven) {
    // The work of the torque that the driven joints have held; then the stiff joints draw from the same tank.
    const auto& tank = keeper_.template get<EnergyTank<T>>();
    auto& shared = m.keeper.template of<EnergyTank<T>>().energy;
    port = skin_torque(model_, JointAngles<M, T>(model_, m.measured.q), contact_part(newest));
    m.driven.tank.energy = shared;
    tank.book(m.driven.tank, Driven::of(m.measured.q - before.q), Driven::of(port), Driven::of(gravity));
    shared = m.driven.tank.energy;
  }

  Torque torque;
  Stiff::put(Stiff::of(m.command.torque), torque);
  for (unsigned j = 0; j < interval.substeps; ++j) {
    const T h = seconds<T>(interval.at(j + 1) - interval.at(j));
    Velocity v1;
    if (following(m)) {
      const auto now = state(m, interval.at(j), velocity(m));
      const auto moved = drive(m, law, law_memory, now, pull, swing, h, touches[j]);
      out.status |= moved.status;
      if (!moved.status.has(Reason::torque_not_finite)) [[likely]] {
        torque = moved.torque;
        v1 = moved.velocity;
        if (!affords(m, v1)) [[unlikely]]
          out.status |= Reason::energy_held;
        law_memory = moved.law.memory;
        out.shares = moved.law.shares;
      }
    }
    const Position from = position(m);
    each([&](auto k) {
      out.status |= std::get<k.value>(virtual_).move(
          m.template group<k.value>(), std::get<k.value>(begun).correction, Part<k.value>::of(v1), h);
    });
    if constexpr (has_tank)
      keeper_.template get<EnergyTank<T>>().book(m.keeper.template of<EnergyTank<T>>(), position(m) - from,
                                                 shape_, h);
  }
  each([&](auto k) { m.template group<k.value>().time = interval.to; });

  // An old velocity is no basis for braking.
  const bool stale = found.has(Reason::state_stale);
  [[maybe_unused]] const Torque drag = stale ? Torque() : friction(m.measured);
  if constexpr (has_driven) Driven::put(Driven::of(gravity - drag), out.fallback);
  DrivenTorque driven = Driven::of(out.fallback), resists = Driven::of(drag);
  if constexpr (has_damper && has_driven) {
    const auto& damping = m.keeper.template of<ContactDamper<T>>().damping;
    if (damping.any && !stale)
      resists += detail::held_damping<Driven>(damping, mass_matrix(model_, m.measured.q), m.measured.dq,
                                              seconds<T>(period()));
  }
  [[maybe_unused]] DrivenTorque passive;
  if constexpr (has_tank && has_driven)
    passive = keeper_.template get<EnergyTank<T>>().settings().port_gain * Driven::of(port) +
              Driven::of(gravity) - resists;
  bool blocked = false, braking = m.stop || stale;
  each([&](auto k) {
    const ResolverMode mode = m.template group<k.value>().mode;
    blocked = blocked || mode == ResolverMode::blocked;
    braking = braking || mode == ResolverMode::braking;
  });
  if (blocked) out.status |= Reason::blocked;
  if (!braking && (has_driven || blocked)) {
    Torque asked;
    DrivenTorque given;
    const auto now = state(m, interval.to, blocked ? Velocity{} : velocity(m));
    const Status status = turn(m, law, law_memory, now, newest, dt, asked, given);
    out.status |= status;
    if (!status.has(Reason::torque_not_finite)) [[likely]] {
      if constexpr (has_driven) {
        driven = given - resists;
        if constexpr (has_tank) out.status |= pay(m, passive, Driven::of(gravity), driven);
      }
      if (blocked) [[unlikely]] {
        torque = limits_.within(asked, Velocity{});
        const Torque net = torque - gravity_torque(model_, now.q);
        each([&](auto k) {
          auto& group = m.template group<k.value>();
          if (group.mode == ResolverMode::blocked)
            std::get<k.value>(virtual_).try_to_leave(group, std::get<k.value>(begun).correction,
                                                     Part<k.value>::of(net));
        });
      }
    }
  }
  if constexpr (has_driven) {
    Driven::put(driven, torque);
    const Torque given = limits_.within(torque, m.measured.dq);
    if (!(Driven::of(given) == driven)) out.status |= Reason::torque_limited;
    m.driven.torque = Driven::of(given);
    Driven::put(m.driven.torque, torque);
    for (const std::size_t i : Driven::index)
      if (!(m.measured.q[i] >= limits_.lower()[i] && m.measured.q[i] <= limits_.upper()[i]))
        out.status |= Reason::outside_limits;
    if constexpr (has_tank)
      keeper_.template get<EnergyTank<T>>().sent(m.driven.tank, m.driven.torque, passive, Driven::of(port),
                                                 Driven::of(gravity));
  }
  each([&](auto k) {
    out.status |= std::get<k.value>(virtual_).end(m.template group<k.value>(), std::get<k.value>(begun),
                                                  Part<k.value>::of(torque));
  });
  compose(m, torque);
  out.command = m.command;
  return out;
}

SKINCTL_GROUPS
void SKINCTL_GROUPS_CLASS::sent(Memory& m, const JointCommand<joints, T>& command) const noexcept {
  if (!m.started || !command.valid) return;
  each([&](auto k) {
    auto& group = m.template group<k.value>();
    const auto given = part_of<Part<k.value>>(command);
    if (!(given.position == group.command.position && given.velocity == group.command.velocity))
      std::get<k.value>(virtual_).sent(group, given);
  });
  if constexpr (has_driven) {
    m.driven.torque = Driven::of(command.torque);
    if constexpr (has_tank) keeper_.template get<EnergyTank<T>>().sent(m.driven.tank, m.driven.torque);
  }
  compose(m, command.torque);
}

SKINCTL_GROUPS
template <class L, class Touch, class Check>
SKINCTL_COLD auto SKINCTL_GROUPS_CLASS::lacking(
    const Memory& m, const State<joints, T>& measured, const Interval& interval, const Check& check,
    const detail::Asked<GroupResolver, L, Touch>& before,
    const detail::Asked<GroupResolver, L, Touch>& next) const noexcept -> JointTorque<joints, T> {
  Torque lacks;
  if (!m.started || m.stop) return lacks;
  const T h = interval.substeps == 0 ? planned_step() : seconds<T>(interval.at(1) - interval.at(0));
  constexpr std::size_t n = Stiff::count;
  using StiffVelocity = JointVelocity<n, T>;
  const ContactDamping<joints, T>* damping = nullptr;
  if constexpr (has_damper) damping = &m.keeper.template of<ContactDamper<T>>().damping;
  const auto here = state(m);
  const auto asks = [&](const auto& who, auto&& use) {
    const Knows<L, Touch> known = who.robot.template known<L>(here, h, who.touch);
    return use(torque_of(who.law, who.memory, known), [&](const StiffTorque& tau) {
      return detail::step_velocity_of<Integrator, Stiff>(known, who.robot.stiff_shape_, false, tau, {},
                                                         Stiff::of(last(m)), damping, who.robot.tool_)
          .velocity;
    });
  };
  if (following(m)) {
    const StiffVelocity wanted = asks(before, [&](const Torque& tau, const auto& moved) {
      return moved(Stiff::of(limits_.within(tau, velocity(m))));
    });
    asks(next, [&](const Torque& whole, const auto& moved) {
      const StiffTorque tau = Stiff::of(whole);
      const StiffVelocity given = moved(tau);
      T slope[n * n], difference[n];
      for (std::size_t j = 0; j < n; ++j) {
        StiffTorque more = tau;
        more[j] += T(1);
        const StiffVelocity there = moved(more);
        for (std::size_t i = 0; i < n; ++i) slope[i * n + j] = there[i] - given[i];
        difference[j] = wanted[j] - given[j];
      }
      StiffTorque found;
      math::Lu<n, T>(slope).solve(difference, found.data);
      Stiff::put(found, lacks);
      return 0;
    });
  }
  if constexpr (has_driven) {
    State<joints, T> newest = m.measured;
    static_cast<void>(take_measurement(newest, measured, interval.to, check));
    State<joints, T> seen = here;
    Driven::put(Driven::of(newest.q), seen.q);
    Driven::put(Driven::of(newest.dq), seen.dq);
    const auto sent_by = [&](const auto& who) {
      const Knows<L, Touch> known = who.robot.template known<L>(seen, seconds<T>(period()), who.touch);
      return torque_of(who.law, who.memory, known) - who.robot.friction(newest);
    };
    Driven::put(Driven::of(sent_by(before) - sent_by(next)), lacks);
  }
  return lacks;
}

#undef SKINCTL_GROUPS
#undef SKINCTL_GROUPS_CLASS

SKINCTL_END_NAMESPACE
