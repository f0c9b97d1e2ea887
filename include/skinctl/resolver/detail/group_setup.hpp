// A resolver for groups of joints, declared in group_resolver.hpp: its configuration, start, and changes.
#pragma once

#include "skinctl/resolver/detail/velocity_step.hpp"
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
  shape_.damping = std::get<0>(stiff).configuration.virtual_dynamics().damping;
  torque_rate_ = std::get<0>(stiff).configuration.torque_rate;
  const auto take = [&](const auto& g) {
    using Given = std::remove_cvref_t<decltype(g)>;
    using Set = JointSubset<joints, Given::set>;
    const auto& c = g.configuration;
    Set::put(c.viscous_friction, shape_.viscous);
    Set::put(c.coulomb_friction, shape_.coulomb);
    Set::put(c.virtual_inertia, shape_.inertia);
    const T damping = c.virtual_dynamics().damping;
    const auto number = [](const T& x) { return static_cast<double>(x); };
    if constexpr (Given::interface == Interface::torque) {
      for (std::size_t i = 0; i < Given::count; ++i) {
        has_friction_ = has_friction_ || c.viscous_friction[i] > T(0);
        require(c.coulomb_friction[i] == T(0), "Coulomb friction", number(c.coulomb_friction[i]),
                "0 for joints by torque");
        require(c.virtual_inertia[i] == T(0), "virtual inertia", number(c.virtual_inertia[i]),
                "0 for joints by torque");
      }
      require(damping == T(0), "virtual damping", number(damping), "0 for joints by torque");
      driven_torque_rate_ = c.torque_rate;
      stale_after_ = c.stale();
    } else {
      for (const T& x : c.coulomb_friction) has_coulomb_ = has_coulomb_ || x > T(0);
      require(damping == shape_.damping, "virtual damping of a group", number(damping),
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
      Torque own;
      Velocity v;
      Stiff::put(Stiff::of(tau), own);
      Stiff::put(Stiff::of(velocity(m)), v);
      return moved(Stiff::of(limits_.within(own, v) == own ? own : limited(here, own)));
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
