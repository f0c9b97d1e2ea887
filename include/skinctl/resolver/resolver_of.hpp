// SPDX-License-Identifier: BSD-3-Clause
// The resolver of a described robot.
#pragma once

#include "skinctl/model/weightless.hpp"
#include "skinctl/resolver/resolver.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A part of a description: room for this many commands under way, for a robot whose delay is longer than 30
/// periods. 32 by default.
template <std::size_t Commands>
struct CommandHistory {
  using RobotPart = detail::HistoryPart;
  static constexpr std::size_t commands = Commands;
};

namespace detail {

/// The parts of a description of one kind, in a tuple.
template <class Kind, class Found, class... Parts>
struct PartsOf {
  using type = Found;
};
template <class Kind, class... Found, class Part, class... Rest>
struct PartsOf<Kind, std::tuple<Found...>, Part, Rest...>
    : PartsOf<Kind,
              std::conditional_t<std::is_same_v<typename Part::RobotPart, Kind>, std::tuple<Found..., Part>,
                                 std::tuple<Found...>>,
              Rest...> {};
/// The only part of a tuple, or a default.
template <class Default, class Tuple>
struct OnlyPart {
  using type = Default;
};
template <class Default, class Part>
struct OnlyPart<Default, std::tuple<Part>> {
  using type = Part;
};

template <class Tuple>
struct PassivityOf;
template <class... K>
struct PassivityOf<std::tuple<K...>> {
  using type = Passivity<K...>;
  template <class Parts>
  static type of(const Parts& parts) {
    return type(std::get<K>(parts)...);
  }
};
/// Integrator, tool shape, command history and passivity among the parts of a description.
template <class... Parts>
struct ChosenParts {
  template <class Kind>
  using Of = typename PartsOf<Kind, std::tuple<>, Parts...>::type;
  template <class Kind>
  static constexpr std::size_t count = std::tuple_size_v<Of<Kind>>;
  static_assert(count<IntegratorPart> <= 1 && count<ToolShapePart> <= 1 && count<HistoryPart> <= 1,
                "a description takes one integrator, one tool shape and one command history");
  using Integrator = typename OnlyPart<CrankNicolson, Of<IntegratorPart>>::type;
  using Tool = typename OnlyPart<NoToolShape, Of<ToolShapePart>>::type;
  using History = typename OnlyPart<CommandHistory<default_history>, Of<HistoryPart>>::type;
  using PassivityParts = PassivityOf<Of<PassivityPart>>;
};

/// The resolver of a described robot, and how it is made of its parts.
template <RobotModel Seen, Real T, class Sets, class... Parts>
struct ResolverOfParts {
  using Chosen = ChosenParts<Parts...>;
  using Tool = typename Chosen::Tool;
  static_assert(Sets::Stiff::count > 0 || (Chosen::template count<IntegratorPart> == 0 &&
                                           Chosen::template count<ToolShapePart> == 0),
                "by torque there is no virtual robot: leave integrator and tool shape out");
  using type = Resolver<Seen, T, Sets, typename Chosen::Integrator, Chosen::History::commands,
                        typename Chosen::PassivityParts::type, Tool>;

  template <class Robot, class Groups>
  [[nodiscard]] static type make(const Robot& robot, const Groups& groups) {
    const auto passivity = Chosen::PassivityParts::of(robot.parts());
    const Seen model(robot.model());
    if constexpr (Chosen::template count<ToolShapePart> == 1) {
      return type(model, groups, passivity, std::get<Tool>(robot.parts()));
    } else {
      return type(model, groups, passivity);
    }
  }
};

template <class Robot>
struct ResolverOf;
template <Interface Ix, RobotModel M, Real T, class... Parts>
struct ResolverOf<RobotDescription<Ix, M, T, Parts...>> {
  using Chosen = ChosenParts<Parts...>;
  using Group = JointGroup<Ix, joints_between(0, M::joints), T>;
  /// The model as laws see it: without weight where the robot itself compensates gravity.
  using Seen = std::conditional_t<(Chosen::template count<RobotHoldsGravity> > 0), Weightless<M>, M>;
  using Of = ResolverOfParts<Seen, T, JointGroups<M::joints, Group>, Parts...>;
  using type = typename Of::type;

  [[nodiscard]] static type make(const RobotDescription<Ix, M, T, Parts...>& robot) {
    return Of::make(robot, std::tuple(Group{robot.configuration()}));
  }
};
template <RobotModel M, Real T, class Groups, class... Parts>
struct ResolverOf<GroupsDescription<M, T, Groups, Parts...>> {
  using Robot = GroupsDescription<M, T, Groups, Parts...>;
  using Chosen = ChosenParts<Parts...>;
  static_assert(
      Chosen::template count<RobotHoldsGravity> + Chosen::template count<RobotCompensatesFriction> +
              Chosen::template count<FrictionUncompensated> + Chosen::template count<StiffestContactPart> ==
          0,
      "of a robot in groups laws compensate gravity and friction, and its stiffest contact cannot be "
      "checked yet: leave RobotHoldsGravity, RobotCompensatesFriction, FrictionUncompensated and "
      "StiffestContact out");
  using Of = ResolverOfParts<M, T, typename Robot::Sets, Parts...>;
  using type = typename Of::type;

  [[nodiscard]] static type make(const Robot& robot) { return Of::make(robot, robot.groups()); }
};

}  // namespace detail

/// The resolver of a robot that is one group of joints.
template <Interface Ix, RobotModel M, Real T = double, class Integrator = CrankNicolson,
          std::size_t History = default_history, class PassivityParts = Passivity<>, class Tool = NoToolShape>
using ResolverBy = Resolver<M, T, JointGroups<M::joints, JointGroup<Ix, joints_between(0, M::joints), T>>,
                            Integrator, History, PassivityParts, Tool>;

namespace detail {
/// A robot's description, from which a resolver is made.
template <class R>
concept Described = requires { typename ResolverOf<R>::type; };
}  // namespace detail

/// The resolver of a robot: for tests and for loops without a `Cycle`.
template <detail::Described Robot>
[[nodiscard]] typename detail::ResolverOf<Robot>::type resolver_of(const Robot& robot) {
  return detail::ResolverOf<Robot>::make(robot);
}

SKINCTL_END_NAMESPACE
