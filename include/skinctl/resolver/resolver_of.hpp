// The resolver of a described robot.
#pragma once

#include "skinctl/model/weightless.hpp"
#include "skinctl/resolver/hybrid_resolver.hpp"
#include "skinctl/resolver/resolver.hpp"
#include "skinctl/resolver/torque_resolver.hpp"

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

template <class Robot>
struct ResolverOf;
template <Interface I, RobotModel M, Real T, class... Parts>
struct ResolverOf<RobotDescription<I, M, T, Parts...>> {
  template <class Kind>
  using Of = typename PartsOf<Kind, std::tuple<>, Parts...>::type;
  template <class Kind>
  static constexpr std::size_t count = std::tuple_size_v<Of<Kind>>;
  static_assert(count<IntegratorPart> <= 1 && count<ToolShapePart> <= 1 && count<HistoryPart> <= 1,
                "a description takes one integrator, one tool shape and one command history");
  static_assert(I != Interface::torque || count<IntegratorPart> + count<ToolShapePart> == 0,
                "by torque there is no virtual robot: leave integrator and tool shape out");

  using Integrator = typename OnlyPart<CrankNicolson, Of<IntegratorPart>>::type;
  using Tool = typename OnlyPart<NoToolShape, Of<ToolShapePart>>::type;
  using History = typename OnlyPart<CommandHistory<32>, Of<HistoryPart>>::type;
  template <class Tuple>
  struct Keeping;
  template <class... K>
  struct Keeping<std::tuple<K...>> {
    using type = Passivity<K...>;
    static type of(const std::tuple<Parts...>& parts) { return type(std::get<K>(parts)...); }
  };
  using Keeper = Keeping<Of<KeeperPart>>;
  /// The model as laws see it: without weight where the robot itself compensates gravity.
  using SeenModel = std::conditional_t<(count<RobotHoldsGravity> > 0), Weightless<M>, M>;
  using type = Resolver<I, SeenModel, T, Integrator, History::commands, typename Keeper::type, Tool>;

  static type make(const RobotDescription<I, M, T, Parts...>& robot) {
    const auto keeper = Keeper::of(robot.parts());
    const SeenModel model(robot.model());
    if constexpr (count<ToolShapePart> == 1) {
      return type(model, robot.configuration(), std::get<Tool>(robot.parts()), keeper);
    } else {
      return type(model, robot.configuration(), keeper);
    }
  }
};

template <Interface I, LinkMask ByTorque, RobotModel M, Real T>
struct ResolverOf<HybridDescription<I, ByTorque, M, T>> {
  using type = HybridResolver<I, ByTorque, M, T>;
  static type make(const HybridDescription<I, ByTorque, M, T>& robot) {
    return type(robot.model(), robot.configuration());
  }
};

}  // namespace detail

/// The resolver of a robot: for tests and for loops without a `Cycle`.
template <class Robot>
  requires requires { typename detail::ResolverOf<Robot>::type; }
[[nodiscard]] typename detail::ResolverOf<Robot>::type resolver_of(const Robot& robot) {
  return detail::ResolverOf<Robot>::make(robot);
}

SKINCTL_END_NAMESPACE
