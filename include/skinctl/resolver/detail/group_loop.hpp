// One cycle of a resolver for groups of joints, declared in group_resolver.hpp.
#pragma once

#include "skinctl/resolver/detail/velocity_step.hpp"
#include "skinctl/resolver/group_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_GROUPS \
  template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class Keeper, class Tool>
#define SKINCTL_GROUPS_CLASS GroupResolver<M, T, Sets, Integrator, History, Keeper, Tool>

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
  if (!(limits_.within(out.torque, v) == out.torque)) [[unlikely]] {
    out.status |= Reason::torque_limited;
    out.torque = limited(now, out.torque);
  }
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

SKINCTL_GROUPS
template <class L, class Touch, class Check, class Pressed>
auto SKINCTL_GROUPS_CLASS::step(Memory& m, const L& law, typename L::Memory& law_memory,
                                const State<joints, T>& measured, const Interval& interval,
                                std::span<const Touch> touches, const Check& check,
                                const Pressed& pressed) const noexcept -> Resolved<joints, T, terms_of<L>> {
  Resolved<joints, T, terms_of<L>> out{m.command, interval.status, {}};
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

#undef SKINCTL_GROUPS
#undef SKINCTL_GROUPS_CLASS

SKINCTL_END_NAMESPACE
