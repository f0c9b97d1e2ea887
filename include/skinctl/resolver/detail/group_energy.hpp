// Energy and contacts in a resolver for groups of joints, declared in group_resolver.hpp.
#pragma once

#include "skinctl/resolver/group_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_GROUPS \
  template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class Keeper, class Tool>
#define SKINCTL_GROUPS_CLASS GroupResolver<M, T, Sets, Integrator, History, Keeper, Tool>

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

#undef SKINCTL_GROUPS
#undef SKINCTL_GROUPS_CLASS

SKINCTL_END_NAMESPACE
