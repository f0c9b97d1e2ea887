// SPDX-License-Identifier: BSD-3-Clause
// Compile-time traits of the parts of a scene: whether they fit, and who compensates gravity and friction.
#pragma once

#include "skinctl/core/detail/each_once.hpp"
#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/no_skin.hpp"
#include "skinctl/cycle/scene_parts.hpp"
#include "skinctl/limits/detail/limit_fault.hpp"
#include "skinctl/model/moving_base.hpp"
#include "skinctl/tactile/detail/touch_fault.hpp"
#include "skinctl/tactile/force_lead.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
/// Whether a skin covers all links whose touch a governor reads.
template <class Governor, class Skin>
inline constexpr bool feels = [] {
  if constexpr (!Governor::reads_touch) {
    return true;
  } else if constexpr (HasLinks<Skin>) {
    return (Skin::Wrenches::links & Governor::links) == Governor::links;
  } else {
    return false;
  }
}();
/// Faults of the parts that are given to a scene.
enum class PartsFault { none, no_part, moves_torques, twice, two_movers, not_felt, no_cells };
/// Whether `Part` is settings of the guard, or a limit or its settings.
template <class Robot, class Part>
inline constexpr bool is_part = GivenGuardSettings<Part> || MakesLimit<Part, Robot> || LimitWithKind<Part>;
/// The limit that a part makes, which is a limit already or its settings.
template <class Robot, class Part>
struct LimitMade {
  using type = decltype(limit_of(std::declval<const Robot&>(), std::declval<const Part&>()));
};
/// The fault of the limit that a part makes; none for settings of the guard.
template <class Robot, class Part>
consteval LimitFault fault_of_part() {
  if constexpr (GivenGuardSettings<Part> || !is_part<Robot, Part>) {
    return LimitFault::none;
  } else {
    using Going =
        skinctl::Going<Robot::joints, typename Robot::scalar, Robot::has_virtual, Robot::has_driven>;
    return fault_in_limit<typename LimitMade<Robot, Part>::type, Going, Robot::joints,
                          typename Robot::scalar>();
  }
}
/// The first fault of a list of parts on a robot with a skin.
template <class Robot, class Skin, class All>
consteval PartsFault fault_in_list() {
  if constexpr (!each_kind_once<All>) {
    return PartsFault::twice;
  } else {
    using Made = GovernorOf<Robot, All>;
    if (Made::movers > 0 && !Robot::has_virtual) return PartsFault::moves_torques;
    if (Made::movers > 1) return PartsFault::two_movers;
    if (!feels<Made, Skin>) return PartsFault::not_felt;
    return Made::reads_coverage && !TouchTable<Skin>::has_coverage ? PartsFault::no_cells : PartsFault::none;
  }
}
/// Whether each of the parts is free of faults by itself.
template <class Robot, class... Given>
inline constexpr bool parts_are_whole = ((fault_of_part<Robot, Given>() == LimitFault::none) && ...);
/// The first fault of the parts `Given` to a scene that has `Parts`, beside those of single limits.
template <class Robot, class Skin, class Parts, class... Given>
consteval PartsFault fault_of_parts() {
  if constexpr (!(is_part<Robot, Given> && ...)) {
    return PartsFault::no_part;
  } else if constexpr (!parts_are_whole<Robot, Given...>) {
    return PartsFault::none;  // the other fault is said
  } else {
    return fault_in_list<
        Robot, Skin, decltype(std::tuple_cat(std::declval<Parts>(), std::declval<std::tuple<Given...>>()))>();
  }
}
/// The touch of a cycle, as the law and the limits of a scene see it.
template <class Skin, class Pressed>
struct Seen {
  static constexpr bool finds_contacts = TouchTable<Skin>::finds_contacts;
  const Skin& skin;
  const typename Skin::Memory& memory;
  const Pressed& pressed_area;
  Nanoseconds now;  ///< end of the interval

  [[nodiscard]] SKINCTL_INLINE const Pressed& pressed() const noexcept { return pressed_area; }
  /// The contacts that skills wait for.
  [[nodiscard]] SKINCTL_INLINE auto contacts() const noexcept {
    return TouchTable<Skin>::contacts(skin, memory);
  }
  /// The strongest proximity reading of link `Ix`, in [0, 1].
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE auto max_proximity() const noexcept {
    return TouchTable<Skin>::template max_proximity<Ix>(skin, memory);
  }
  [[nodiscard]] SKINCTL_INLINE Coverage coverage() const noexcept {
    return TouchTable<Skin>::coverage(skin, memory);
  }
  /// Whether the laws feel a push.
  [[nodiscard]] SKINCTL_INLINE bool touched() const noexcept {
    return !(skin.wrenches(memory) == typename Skin::Wrenches{});
  }
  /// The least reading of a push on the `i`-th cell that somebody notices; infinite: nobody, or no such cell.
  [[nodiscard]] SKINCTL_INLINE double noticed(std::size_t i) const noexcept {
    return i < TouchTable<Skin>::size(skin) ? TouchTable<Skin>::noticed(skin, memory, i)
                                            : std::numeric_limits<double>::infinity();
  }
};
/// Whether a robot is one group of joints that takes positions.
template <class Resolver>
inline constexpr bool takes_positions = [] {
  if constexpr (Resolver::is_one_group) return takes_position(Resolver::interface);
  return false;
}();
/// The touch that a resolver takes from a skin: forces and proximities apart where a tank or a spring has to
/// distinguish them, and where contacts are asked for (`Contacts`) and not known otherwise.
template <class Resolver, class Skin, bool Contacts>
struct TouchFor {
  using type = typename Skin::Wrenches;
};
template <class Resolver, class Skin, bool Contacts>
  requires(Resolver::has_tank || Resolver::gives_way ||
           (Contacts && !TouchTable<Skin>::template knows_pressed<typename Skin::Wrenches>))
struct TouchFor<Resolver, Skin, Contacts> {
  using type = typename TouchTable<Skin>::Touch;
};
/// The `TouchChange` of a scene's touch; nothing for a touch that laws cannot get ahead.
template <class Wrenches>
struct ChangeOf {
  struct Memory {};
};
template <class Wrenches>
  requires can_be_led<Wrenches>
struct ChangeOf<Wrenches> : TouchChange<Wrenches> {};
/// The contacts, if the scene has a part that asks for them: where the skin is pressed, or else the wrenches
/// of the touch at the end of the interval.
template <bool Contacts, class Skin, class Touch>
[[nodiscard]] SKINCTL_INLINE auto pressed(const Skin& skin, const typename Skin::Memory& memory,
                                          const Touch& touch) noexcept {
  if constexpr (!Contacts) {
    return PressedUnknown{};
  } else {
    return TouchTable<Skin>::pressed(skin, memory, touch);
  }
}
template <class Limit>
struct LimitInput {
  using type = NothingAdded;
};
template <LimitWithInput Limit>
struct LimitInput<Limit> {
  using type = typename Limit::Input;
};
/// The addition of the robot to the input of a cycle: the state of a base that moves.
template <RobotModel M, Real T>
using RobotInput = std::conditional_t<base_moves<M>, BaseInput<T>, NothingAdded>;
/// The additions of robot, law and limits to the input of a cycle, as a tuple: each once.
template <class L, class Governor>
struct AddedInputsOf;
template <class L, RobotModel M, Real T, class Sets, class... Limits>
struct AddedInputsOf<L, Governor<M, T, Sets, Limits...>>
    : EachOnce<std::tuple<>, typename LawTable<L>::Input, typename LimitInput<Limits>::type...,
               RobotInput<M, T>> {};
template <class L, class Governor>
using AddedInputs = typename AddedInputsOf<L, Governor>::type;
/// Takes what was sensed in an interval, and gives the mean touch over each of its parts. `measured()` is the
/// newest good state of the robot, for sensors that need one.
template <class Skin, class Input, class Measured, class Touch>
SKINCTL_INLINE Status receive_touch(const Skin& skin, typename Skin::Memory& memory, const Input& input,
                                    const Measured& measured, const Interval& interval, std::size_t parts,
                                    Touch* touches) noexcept {
  const auto& state = [&]() -> const auto& {
    if constexpr (TouchTable<Skin>::is_sensor) {
      return measured();
    } else {
      return input.measured;
    }
  }();
  return TouchTable<Skin>::receive(
      skin, memory, TouchGiven{input.samples, input.sensed, state, interval.from, interval.to, parts},
      touches);
}
struct SkinBehindLaw {};
struct SkinForgotten {};
struct ModelAsRobot {};
/// No change: the configuration is that of the last cycle.
struct NoChange {
  template <class C, class Memory, class Receive>
  SKINCTL_INLINE Status receive(const C&, Memory&, const Receive& goal) const noexcept {
    return goal();
  }
  template <class C, class Memory, class State>
  SKINCTL_INLINE void carry(const C&, Memory&, const State&, const Interval&) const noexcept {}
};

/// The resolver of a robot's description; a resolver built by hand passes.
template <class R>
[[nodiscard]] auto as_resolver(const R& robot) {
  if constexpr (Described<R>) {
    return resolver_of(robot);
  } else {
    return robot;
  }
}
template <class R>
using ResolverFor = decltype(as_resolver(std::declval<const R&>()));

template <class S>
concept SkinLike = MeantAsTouch<S>;

/// Whether the law, or the robot by its description, compensates gravity; a resolver built by hand is not
/// asked.
template <class Robot, class L>
inline constexpr bool gravity_is_held = [] {
  if constexpr (DescribedRobot<Robot>) {
    return Robot::robot_holds_gravity || LawTable<L>::holds_gravity;
  } else {
    return !Described<Robot> || LawTable<L>::holds_gravity;
  }
}();
/// Compares the robot's description with the law, at compile time: whether both compensate gravity, and who
/// friction.
template <class Robot, class L>
constexpr void check_holders() {
  if constexpr (DescribedRobot<Robot>) {
    // Skills name the controller in their rows: without weight it gives zero.
    constexpr bool has_gravity_law = LawTable<L>::gravity_laws > 0 && !LawTable<L>::is_complete_sum;
    static_assert(!Robot::robot_holds_gravity || !has_gravity_law,
                  "gravity twice: the robot holds it, and so does the law: leave GravityControl out");
    if constexpr (Robot::interface == Interface::torque) {
      static_assert(
          !(Robot::robot_compensates_friction && LawTable<L>::compensates_friction),
          "friction twice: the robot compensates it, and so does the law: leave FrictionControl out");
      static_assert(!(Robot::friction_uncompensated && LawTable<L>::compensates_friction),
                    "friction: described as uncompensated, and a law compensates it: leave one of them out");
      static_assert(Robot::robot_compensates_friction || Robot::friction_uncompensated ||
                        LawTable<L>::compensates_friction,
                    "friction nowhere: describe RobotCompensatesFriction or FrictionUncompensated, or add "
                    "FrictionControl");
    }
  }
}
/// Compares the law's settings with the robot's description; throws `ConfigurationError` with both numbers.
template <class Robot, class L>
SKINCTL_COLD void check_settings(const Robot& robot, const L& law) {
  const LawTerms<Robot::joints, typename Robot::scalar> terms{robot.longest_dt(), robot.virtual_dynamics(),
                                                              robot.loop_delay()};
  LawTable<L>::check_for(law, terms);
}
/// Checks that the stiffest contact that a description names comes to rest on this skin.
template <class Robot, class Skin>
SKINCTL_COLD void check_contacts(const Robot& robot, const Skin& skin) {
  const auto check = [&]<class Part>(const Part& given_part) {
    if constexpr (std::is_same_v<typename Part::RobotPart, StiffestContactPart>)
      given_part.check(robot, skin);
  };
  std::apply([&](const auto&... given_part) { (check(given_part), ...); }, robot.parts());
}
}  // namespace detail
SKINCTL_END_NAMESPACE
