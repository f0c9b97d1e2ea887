// The resolver of a described robot.
#pragma once

#include "skinctl/model/weightless.hpp"
#include "skinctl/resolver/resolver.hpp"
#include "skinctl/resolver/torque_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE

template <RobotModel M, Real T, class Groups, class... Parts>
class GroupsDescription;

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
struct KeeperOf;
template <class... K>
struct KeeperOf<std::tuple<K...>> {
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
  using History = typename OnlyPart<CommandHistory<32>, Of<HistoryPart>>::type;
  using Keeper = KeeperOf<Of<KeeperPart>>;
};

template <class Robot>
struct ResolverOf;
/// In `group_resolver.hpp`.
template <class Robot>
struct GroupResolverOf {
  static_assert(!std::is_same_v<Robot, Robot>,
                "a robot in groups of joints: #include \"skinctl/cycle/groups.hpp\"");
};
template <Interface I, RobotModel M, Real T, class... Parts>
struct ResolverOf<RobotDescription<I, M, T, Parts...>> {
  using Chosen = ChosenParts<Parts...>;
  using Tool = typename Chosen::Tool;
  static constexpr bool has_tool = Chosen::template count<ToolShapePart> == 1;
  static_assert(I != Interface::torque || (Chosen::template count<IntegratorPart> == 0 && !has_tool),
                "by torque there is no virtual robot: leave integrator and tool shape out");
  /// The model as laws see it: without weight where the robot itself compensates gravity.
  using SeenModel = std::conditional_t<(Chosen::template count<RobotHoldsGravity> > 0), Weightless<M>, M>;
  using type = Resolver<I, SeenModel, T, typename Chosen::Integrator, Chosen::History::commands,
                        typename Chosen::Keeper::type, Tool>;

  static type make(const RobotDescription<I, M, T, Parts...>& robot) {
    const auto keeper = Chosen::Keeper::of(robot.parts());
    const SeenModel model(robot.model());
    if constexpr (has_tool) {
      return type(model, robot.configuration(), std::get<Tool>(robot.parts()), keeper);
    } else {
      return type(model, robot.configuration(), keeper);
    }
  }
};

template <RobotModel M, Real T, class Groups, class... Parts>
struct ResolverOf<GroupsDescription<M, T, Groups, Parts...>>
    : GroupResolverOf<GroupsDescription<M, T, Groups, Parts...>> {};

}  // namespace detail

/// The resolver of a robot: for tests and for loops without a `Cycle`.
template <class Robot>
  requires requires { typename detail::ResolverOf<Robot>::type; }
[[nodiscard]] typename detail::ResolverOf<Robot>::type resolver_of(const Robot& robot) {
  return detail::ResolverOf<Robot>::make(robot);
}

SKINCTL_END_NAMESPACE
