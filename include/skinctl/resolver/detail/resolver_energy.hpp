// SPDX-License-Identifier: BSD-3-Clause
// Energy and contacts in a resolver.
#pragma once

#include "skinctl/resolver/detail/affordable.hpp"
#include "skinctl/resolver/detail/resolver_state.hpp"

SKINCTL_BEGIN_NAMESPACE

/// In place of pressed areas: the resolver takes the contacts from the wrenches of the touch.
struct PressedUnknown {};

namespace detail {

/// The part of a `Resolver` that serves its `Passivity`: the inputs of a cycle, and the motion they leave.
template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class PassivityParts,
          class Tool>
class ResolverEnergy : public ResolverState<M, T, Sets, Integrator, History, PassivityParts, Tool> {
  using Base = ResolverState<M, T, Sets, Integrator, History, PassivityParts, Tool>;

 public:
  using Base::has_driven;
  using Base::has_passivity_observer;
  using Base::has_tank;
  using Base::joints;
  using Base::watches_contacts;
  using Driven = typename Base::Driven;
  using Memory = typename Base::Memory;
  template <std::size_t K>
  using Group = typename Base::template Group<K>;
  template <std::size_t K>
  using Part = typename Base::template Part<K>;

 protected:
  using Base::Base;
  using Base::each;
  using Base::limits_;
  using Base::model_;
  using Base::passivity_;
  using Base::virtual_;
  using Position = typename Base::Position;
  using Velocity = typename Base::Velocity;
  using Torque = typename Base::Torque;
  using DrivenTorque = typename Base::DrivenTorque;

  /// Gives the passivity parts their inputs in a cycle of `dt` seconds. The observer watches over the stiff
  /// joints: motion of a contact by joints by torque is not ahead of the measurement.
  template <class Pressed, class Touch>
  SKINCTL_INLINE Status watch(Memory& m, const Pressed& pressed, const Touch& touch,
                              const T& dt) const noexcept {
    if constexpr (!watches_contacts) {
      return {};
    } else if constexpr (std::is_same_v<Pressed, PressedUnknown>) {
      return observe(m, contacts_of(model_, m.measured().q, contact_part(touch)), dt);
    } else {
      return observe(m, contacts_of(model_, m.measured().q, pressed), dt);
    }
  }
  /// Slows the stiff joints' velocity `v` to what the observer can pay for; false if it was slowed.
  SKINCTL_INLINE bool affords(const Memory& m, Velocity& v) const noexcept {
    if constexpr (has_passivity_observer) {
      return slow_to_afford(passivity_.template get<PassivityObserver<T>>(),
                            m.passivity.template of<PassivityObserver<T>>(), v,
                            [&](const Velocity& u) { return way_to_rest(m, u); });
    } else {
      return true;
    }
  }
  /// Scales the active part of the torque of joints by torque down to the share that the tank pays for. Their
  /// motion is predicted for stiff joints that move steadily; what it was is booked in the next cycle.
  SKINCTL_INLINE Status pay(Memory& m, const DrivenTorque& passive, const DrivenTorque& gravity,
                            DrivenTorque& torque) const noexcept {
    const auto& tank = passivity_.template get<EnergyTank<T>>();
    auto& held_tank = m.driven.tank;
    held_tank.energy = m.passivity.template of<EnergyTank<T>>().energy;
    Torque whole;
    Driven::put(torque, whole);
    const auto& now = m.measured();
    DrivenTorque active = Driven::of(limits_.within(whole, now.dq)) - passive;
    const JointAngles<M, T> angles(model_, now.q);
    const DrivenTorque bias = gravity + Driven::of(coriolis_torque(model_, angles, now.dq));
    const auto mass = this->real_mass(now.q);
    const math::Ldlt<Driven::count, T> factors(block_of<Driven>(mass).data);
    const auto v = Driven::of(now.dq);
    const T h = seconds<T>(this->period()), delay = seconds<T>(this->driven_delay() + this->driven_lag());
    const T share = tank.pay(held_tank, passive, active, v, h, delay, [&](const DrivenTorque& tau) {
      const DrivenTorque net = tau - bias;
      JointAcceleration<Driven::count, T> given;
      if (factors.positive_definite()) factors.solve(net.data, given.data);
      return integrate(v, given, T(h + delay));
    });
    if (!(share < T(1))) return {};
    const T damping = tank.settings().damping * (T(1) - share);
    torque = passive + active - damping * momentum_of<Driven>(mass, now.dq);
    return Reason::tank_empty;
  }

 private:
  template <class Contacts>
  SKINCTL_INLINE Status observe(Memory& m, Contacts contacts, const T& dt) const noexcept {
    Status status;
    if constexpr (has_passivity_observer) {
      if constexpr (has_driven)
        for (std::size_t k = 0; k < contacts.count; ++k)
          for (const std::size_t i : Driven::index) contacts.list[k].row[i] = T(0);
      passivity_.template get<PassivityObserver<T>>().book(m.passivity.template of<PassivityObserver<T>>(),
                                                           contacts, m.measured().q, this->total_delay() / dt,
                                                           [&](auto&& f) { each_way_under_way(m, f); });
    }
    return status;
  }
  /// Calls `f` with the displacements from the measured position that commands under way lead to.
  template <class F>
  SKINCTL_INLINE void each_way_under_way(const Memory& m, F& f) const noexcept {
    each([&](auto k) {
      constexpr bool here = takes_position(Group<k.value>::interface);
      const auto& group = m.template group<k.value>();
      std::get<k.value>(virtual_).servo().each_under_way(group.under_way, [&](const auto& q) {
        Position way;
        // The other groups' furthest command is their last one.
        each([&](auto other) {
          const auto& o = m.template group<other.value>();
          constexpr bool by_position = takes_position(Group<other.value>::interface);
          Part<other.value>::put(by_position ? o.q.value - o.measured.q : o.sent.value - o.under_way.reached,
                                 way);
        });
        Part<k.value>::put(q - (here ? group.measured.q : group.under_way.reached), way);
        f(way);
      });
    });
  }
  /// The displacement from the measured position to where the stiff joints come to rest that move at `u`.
  SKINCTL_INLINE Position way_to_rest(const Memory& m, const Velocity& u) const noexcept {
    Position dq;
    each([&](auto k) {
      const auto& group = m.template group<k.value>();
      const auto& p = this->template parameters<k.value>();
      constexpr bool by_position = takes_position(Group<k.value>::interface);
      for (std::size_t j = 0; j < Group<k.value>::count; ++j) {
        const std::size_t i = Part<k.value>::index[j];
        const T speed = u[i] < T(0) ? T(-u[i]) : u[i];
        const T from = by_position ? group.measured.q[j] : group.under_way.reached[j];
        const T sent = by_position ? group.q.value[j] : group.sent.value[j];
        dq[i] = sent - from + u[i] * (p.cycle + T(0.5) * speed / p.limits.acceleration()[j]);
      }
    });
    return dq;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
