// The loop of the resolver, declared in resolver.hpp.
#pragma once

#include "skinctl/core/detail/copy_whole.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/resolver/detail/affordable.hpp"
#include "skinctl/resolver/detail/velocity_step.hpp"
#include "skinctl/resolver/resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_RESOLVER                                                                            \
  template <Interface I, RobotModel M, Real T, class Integrator, std::size_t History, class Keeper, \
            class Tool>
#define SKINCTL_RESOLVER_CLASS Resolver<I, M, T, Integrator, History, Keeper, Tool>

/// The inputs of the passivity parts in a cycle: the contacts, the measured position, the commands under way.
SKINCTL_RESOLVER
template <class Pressed>
SKINCTL_INLINE Status SKINCTL_RESOLVER_CLASS::watch(Memory& m, const Pressed& pressed,
                                                    const T& dt) const noexcept {
  Status status;
  if constexpr (watches_contacts) {
    const auto contacts = contacts_of(model_, m.measured.q, pressed);
    if constexpr (has_damper)
      if (keeper_.template get<ContactDamper<T>>().observe(m.keeper.template of<ContactDamper<T>>(), contacts,
                                                           m.measured.dq, dt))
        status |= Reason::contact_damped;
    if constexpr (has_passivity_observer)
      keeper_.template get<PassivityObserver<T>>().book(
          m.keeper.template of<PassivityObserver<T>>(), contacts, m.measured.q, parameters().total_delay / dt,
          [&](auto&& f) {
            virtual_.servo().each_under_way(m.under_way, [&](const Position& q) {
              f(I == Interface::position ? q - m.measured.q : q - m.under_way.reached);
            });
          });
  }
  return status;
}

SKINCTL_RESOLVER
SKINCTL_INLINE bool SKINCTL_RESOLVER_CLASS::affords(const Memory& m, Velocity& v) const noexcept {
  if constexpr (has_passivity_observer) {
    const Position& from = I == Interface::position ? m.measured.q : m.under_way.reached;
    const Position& sent = I == Interface::position ? m.q.value : m.sent.value;
    const T ahead = parameters().lead + seconds<T>(parameters().period);
    return detail::slow_to_afford(
        keeper_.template get<PassivityObserver<T>>(), m.keeper.template of<PassivityObserver<T>>(), v,
        [&](const Velocity& u) {
          Position dq;
          for (std::size_t i = 0; i < joints; ++i) {
            const T speed = u[i] < T(0) ? T(-u[i]) : u[i];
            dq[i] =
                sent[i] - from[i] + u[i] * (ahead + T(0.5) * speed / parameters().limits.acceleration()[i]);
          }
          return dq;
        });
  } else {
    return true;
  }
}

// With the angles of all joints, as the laws have them: a blocked robot needs no code of its own.
SKINCTL_RESOLVER
SKINCTL_COLD auto SKINCTL_RESOLVER_CLASS::weight(const Memory& m) const noexcept -> Torque {
  return gravity_torque(model_, JointAngles<M, T>(model_, m.q.value));
}

// With Coriolis forces too: at full speed they are as large as what is left of a light joint's torque.
SKINCTL_RESOLVER
SKINCTL_COLD auto SKINCTL_RESOLVER_CLASS::limited(const State<joints, T>& state,
                                                  const Torque& tau) const noexcept -> Torque {
  return parameters().limits.along(tau, bias_torque(model_, JointAngles<M, T>(model_, state.q), state.dq),
                                   state.dq);
}

// One function for the sub-steps and for a blocked robot: the law is the largest part of a cycle's code.
SKINCTL_RESOLVER
template <class L, class Touch>
SKINCTL_NOINLINE auto SKINCTL_RESOLVER_CLASS::drive(Memory& m, const L& law,
                                                    const typename L::Memory& law_memory, Nanoseconds at,
                                                    const Velocity& v,
                                                    const JointAcceleration<joints, T>& pull, const T& h,
                                                    const Touch& touch) const noexcept -> Driven<L> {
  const State<joints, T> state{at, Position(Row(m.q.value)), Velocity(Row(v))};
  const auto& total = total_of(touch);
  detail::BiasBeside<joints, T> beside;
  const Knows<L, LawTouch<Touch>> known = this->template known<L>(state, h, total, &beside);
  beside.v = detail::middle_velocity<AllJoints<joints>>(known, m.last);
  Driven<L> out([&]() SKINCTL_INLINE_LAMBDA { return evaluate(law, law_memory, known, h); });
  if (!detail::is_finite(out.law.torque)) [[unlikely]] {
    out.status |= Reason::torque_not_finite;
    return out;
  }
  detail::copy_row(out.law.torque, out.torque);
  if (m.own.template bound<L>(out.law.shares, parameters().torque_step(h), out.torque)) [[unlikely]]
    out.status |= Reason::torque_limited;
  const Row asked = out.torque, given = parameters().limits.within(out.torque, state.dq);
  given.store(out.torque);
  if (any(given != asked)) [[unlikely]] {
    out.status |= Reason::torque_limited;
    out.torque = limited(state, Torque(asked));
  }
  const ContactDamping<joints, T>* damping = nullptr;
  if constexpr (has_damper) {
    const auto& d = m.keeper.template of<ContactDamper<T>>().damping;
    if (d.any) damping = &d;
  }
  const auto next = detail::step_velocity<Integrator>(known, parameters().shape, parameters().has_coulomb,
                                                      out.torque, pull, m.last, damping, tool_);
  if (next.singular) out.status |= Reason::singular;
  detail::copy_row(next.velocity, out.velocity);
  if constexpr (has_tank) {
    const auto& tank = keeper_.template get<EnergyTank<T>>();
    auto& memory = m.keeper.template of<EnergyTank<T>>();
    tank.charge(memory, known.mass(), state.dq);
    const Torque port = skin_torque(model_, known.angles(), contact_part(touch));
    const Torque passive = tank.settings().port_gain * port + known.gravity();
    const T share = tank.pay(memory, port, out.torque - passive, state.dq, out.velocity, h, [&] {
      return detail::step_velocity<Integrator>(known, parameters().shape, parameters().has_coulomb, passive,
                                               {}, m.last, damping, tool_)
          .velocity;
    });
    if (share < T(1)) {
      out.status |= Reason::tank_empty;
      out.torque = passive + share * (out.torque - passive);
    }
  }
  return out;
}

SKINCTL_RESOLVER
template <class L, class Touch, class Check, class Pressed>
SKINCTL_INLINE auto SKINCTL_RESOLVER_CLASS::step(Memory& m, const L& law, typename L::Memory& law_memory,
                                                 const State<joints, T>& measured, const Interval& interval,
                                                 std::span<const Touch> touches, const Check& check,
                                                 const Pressed& pressed) const noexcept
    -> Resolved<joints, T, terms_of<L>> {
  if (!m.started || interval.substeps == 0) [[unlikely]] {
    m.odd = detail::odd_time_of(interval);
    return {m.command, interval.status, {}};
  }
  SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
  // GCC zeroes them with an instruction that starts slowly: only where no law shows its own.
  detail::UnwrittenIfTrivial<std::array<Torque, terms_of<L>>> shares;
  bool shown = false;
  const auto begun = virtual_.begin(m, measured, interval, check);
  Status status = begun.status;
  if constexpr (std::is_same_v<Pressed, PressedUnknown>) {
    status |= watch(m, contact_part(touches[interval.substeps - 1]), begun.dt);
  } else {
    status |= watch(m, pressed, begun.dt);
  }

  Torque torque = m.command.torque;
  for (unsigned j = 0; j < interval.substeps; ++j) {
    const T h = seconds<T>(interval.at(j + 1) - interval.at(j));
    Velocity v1;
    if (m.mode == ResolverMode::following) {
      const auto driven =
          drive(m, law, law_memory, interval.at(j), m.v, begun.correction.pull, h, touches[j]);
      status |= driven.status;
      detail::copy_row(driven.velocity, v1);
      if (!affords(m, v1)) [[unlikely]]
        status |= Reason::energy_held;
      if (!driven.status.has(Reason::torque_not_finite)) [[likely]] {
        detail::copy_row(driven.torque, torque);
        detail::copy_whole(driven.law.memory, law_memory);
        detail::copy_whole(driven.law.shares, shares.data[0]);
        shown = true;
      }
    }
    const Position from(Row(m.q.value));
    status |= virtual_.move(m, begun.correction, v1, h);
    if constexpr (has_tank)
      keeper_.template get<EnergyTank<T>>().book(m.keeper.template of<EnergyTank<T>>(), m.q.value - from,
                                                 parameters().shape, h);
  }
  m.time = interval.to;
  if (m.mode == ResolverMode::blocked && !m.stop) {
    const auto driven = drive(m, law, law_memory, m.time, Velocity{}, {}, seconds<T>(parameters().period),
                              touches[interval.substeps - 1]);
    status |= Reason::blocked;
    if (!driven.status.has(Reason::torque_not_finite)) {
      torque = driven.torque;
      virtual_.try_to_leave(m, begun.correction, torque - weight(m));
    }
  }
  status |= virtual_.end(m, begun, torque);
  if (!shown) [[unlikely]]
    shares.data[0] = {};
  return {m.command, status, shares.data[0]};
}

SKINCTL_RESOLVER
template <class L, class Touch, class Check>
SKINCTL_COLD auto SKINCTL_RESOLVER_CLASS::lacking(
    const Memory& m, const State<joints, T>&, const Interval& interval, const Check&,
    const detail::Asked<Resolver, L, Touch>& before,
    const detail::Asked<Resolver, L, Touch>& next) const noexcept -> JointTorque<joints, T> {
  if (!m.started || m.stop || m.mode != ResolverMode::following) return {};
  const T h = interval.substeps == 0 ? planned_step() : seconds<T>(interval.at(1) - interval.at(0));
  const ContactDamping<joints, T>* damping = nullptr;
  if constexpr (has_damper) damping = &m.keeper.template of<ContactDamper<T>>().damping;
  const State<joints, T> here = state(m);
  const auto asks = [&](const auto& who, auto&& use) {
    const Knows<L, Touch> known = who.robot.template known<L>(here, h, who.touch);
    return use(torque_of(who.law, who.memory, known), [&](const Torque& tau) {
      return detail::step_velocity<Integrator>(known, who.robot.parameters().shape, false, tau, {}, m.last,
                                               damping, who.robot.tool_)
          .velocity;
    });
  };
  const Velocity wanted = asks(before, [&](const Torque& tau, const auto& moved) {
    const bool fits = parameters().limits.within(tau, m.v) == tau;
    return moved(fits ? tau : limited(here, tau));
  });
  return asks(next, [&](const Torque& tau, const auto& moved) {
    const Velocity given = moved(tau);
    T slope[joints * joints], difference[joints];
    for (std::size_t j = 0; j < joints; ++j) {
      Torque more = tau;
      more[j] += T(1);
      const Velocity there = moved(more);
      for (std::size_t i = 0; i < joints; ++i) slope[i * joints + j] = there[i] - given[i];
      difference[j] = wanted[j] - given[j];
    }
    Torque lacks;
    math::Lu<joints, T>(slope).solve(difference, lacks.data);
    return lacks;
  });
}

#undef SKINCTL_RESOLVER
#undef SKINCTL_RESOLVER_CLASS

SKINCTL_END_NAMESPACE
