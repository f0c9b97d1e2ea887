// Compile-time traits of the parts of a scene: whether they fit, and who compensates gravity and friction.
#pragma once

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/no_skin.hpp"
#include "skinctl/cycle/scene_parts.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
template <class Overseer>
inline constexpr bool is_governor = false;
template <std::size_t N, Real T, class... Parts>
inline constexpr bool is_governor<Governor<N, T, Parts...>> = true;
template <class Overseer>
inline constexpr bool limits_jerk = requires { requires Overseer::has_jerk; };
/// Whether a governor suits a robot's joints and scalar.
template <class Overseer, std::size_t N, class T>
inline constexpr bool governs = true;
template <std::size_t M, Real U, class... Parts, std::size_t N, class T>
inline constexpr bool governs<Governor<M, U, Parts...>, N, T> = M == N && std::is_same_v<U, T>;
/// Whether a skin covers all links of a governor's contact limits.
template <class Overseer, class Skin>
inline constexpr bool feels = [] {
  if constexpr (!requires { Overseer::contact_type::links; }) {
    return true;
  } else if constexpr (requires { Skin::Wrenches::links; }) {
    constexpr LinkMask named = Overseer::contact_type::links;
    return (Skin::Wrenches::links & named) == named;
  } else {
    return false;
  }
}();
/// The strongest proximity reading for each link of a governor's contact limits.
template <class Overseer, class Skin>
[[nodiscard]] SKINCTL_INLINE auto nearest(const Skin& skin, const typename Skin::Memory& memory) noexcept {
  if constexpr (requires { Overseer::contact_type::links; }) {
    return Overseer::contact_type::nearest(skin, memory);
  } else {
    return NoTouch{};
  }
}
/// Whether a governor watches how much of the skin feels.
template <class Overseer>
inline constexpr bool watches_skin = requires { requires Overseer::has_watch; };
/// Whether a resolver commands motion of any joint.
template <class Resolver>
inline constexpr bool commands_motion = [] { return Resolver::has_virtual; }();
template <class Resolver>
inline constexpr bool watches_contacts = requires { requires Resolver::watches_contacts; };
/// Whether a skin says where it is pressed, beside the touch `Touch` of other sensors.
template <class Skin, class Touch>
concept KnowsPressed = requires(const Skin& skin, const typename Skin::Memory& memory, const Touch& touch) {
  skin.pressed(memory, touch);
};
template <class Resolver>
inline constexpr bool takes_positions = requires { requires Resolver::interface == Interface::position; };
/// The touch that a resolver takes from a skin: forces and proximities apart where a tank has to tell them, and
/// where contacts are asked for (`Contacts`) and not known otherwise.
template <class Resolver, class Skin, bool Contacts>
struct TouchFor {
  using type = typename Skin::Wrenches;
};
template <class Resolver, class Skin, bool Contacts>
  requires requires {
    typename Skin::Touch;
    requires Resolver::has_tank || (Contacts && !KnowsPressed<Skin, typename Skin::Wrenches>);
  }
struct TouchFor<Resolver, Skin, Contacts> {
  using type = typename Skin::Touch;
};
/// The contacts, if the scene has a part that asks for them: where the skin is pressed, or else the wrenches of
/// the touch at the end of the interval.
template <bool Contacts, class Skin, class Touch>
[[nodiscard]] SKINCTL_INLINE auto pressed(const Skin& skin, const typename Skin::Memory& memory,
                                          const Touch& touch) noexcept {
  if constexpr (!Contacts) {
    return PressedUnknown{};
  } else if constexpr (KnowsPressed<Skin, Touch>) {
    return skin.pressed(memory, touch);
  } else {
    return contact_part(touch);
  }
}
/// Whether a law has a gripper: a `SkillSet` with `OneGripper`.
template <class L>
inline constexpr bool has_gripper = requires { requires L::has_gripper; };
/// What the touch of a scene adds to its input: nothing for cells, see `TouchSensor`.
template <class Skin>
struct SensedBy {
  using type = NoSensors;
};
template <class Skin>
  requires requires { typename Skin::Sensed; }
struct SensedBy<Skin> {
  using type = typename Skin::Sensed;
};
/// What a governor's clearances add to a scene's input.
template <class Governor>
struct AroundOf {
  using type = NoSurroundings;
};
template <class Governor>
  requires requires { requires Governor::has_surroundings; }
struct AroundOf<Governor> {
  using type = typename std::remove_cvref_t<decltype(std::declval<const Governor&>().clearance())>::Near;
};
/// Takes what was sensed in an interval, and gives the mean touch over each of its parts. `measured()` is the
/// newest good state of the robot, for sensors that need one.
template <class Skin, class Input, class Measured, class Touch>
SKINCTL_INLINE Status receive_touch(const Skin& skin, typename Skin::Memory& memory, const Input& input,
                                    const Measured& measured, const Interval& interval, std::size_t parts,
                                    Touch* touches) noexcept {
  if constexpr (requires { typename Skin::Sensed; }) {
    return skin.receive(memory, input.samples, input.sensed, measured(), interval.from, interval.to, parts,
                        touches);
  } else {
    return skin.receive(memory, input.samples, interval.from, interval.to, parts, touches);
  }
}
template <class L>
struct GoalType {
  using type = NoGoal;
};
template <class L>
  requires requires { typename L::Goal; }
struct GoalType<L> {
  using type = typename L::Goal;
};
struct SkinBehindLaw {};
/// The configuration is that of the last cycle.
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
concept SkinLike = requires { typename S::Wrenches; };
template <class G>
concept GuardLike = requires(const G& g, typename G::Memory& m) { g.acknowledge(m); };
template <class G>
concept GovernorLike = is_governor<G> || std::is_same_v<G, NoGovernor>;

/// Whether a law compensates gravity: by a gravity law, or within `Y_r Theta`.
template <class L>
inline constexpr bool holds_gravity = [] {
  if constexpr (requires { L::gravity_laws; }) {
    return L::gravity_laws > 0 || L::role == LawRole::tracking;
  } else {
    return L::role != LawRole::reactive;
  }
}();
/// Whether a gravity law is loaded that cannot leave gravity to the robot.
template <class L>
inline constexpr bool has_gravity_law = [] {
  if constexpr (requires { L::complete_sum; }) {
    return false;  // skills: their rows name the controller; without weight it gives zero
  } else if constexpr (requires { L::gravity_laws; }) {
    return L::gravity_laws > 0;
  } else {
    return L::role == LawRole::gravity;
  }
}();
template <class L>
inline constexpr bool law_compensates_friction = requires { requires L::compensates_friction; };

/// Compares the robot's description with the law, at compile time: who compensates gravity and friction.
template <class Robot, class L>
constexpr void check_holders() {
  if constexpr (requires { Robot::robot_holds_gravity; }) {
    static_assert(!Robot::robot_holds_gravity || !has_gravity_law<L>,
                  "gravity twice: the robot holds it, and so does the law: leave GravityControl out");
    static_assert(Robot::robot_holds_gravity || holds_gravity<L>,
                  "gravity nowhere: add GravityControl to the law, or RobotHoldsGravity to the description");
    if constexpr (Robot::interface == Interface::torque) {
      static_assert(
          !(Robot::robot_compensates_friction && law_compensates_friction<L>),
          "friction twice: the robot compensates it, and so does the law: leave FrictionControl out");
      static_assert(!(Robot::friction_uncompensated && law_compensates_friction<L>),
                    "friction: described as uncompensated, and a law compensates it: leave one of them out");
      static_assert(
          Robot::robot_compensates_friction || Robot::friction_uncompensated || law_compensates_friction<L>,
          "friction nowhere: describe RobotCompensatesFriction or FrictionUncompensated, or add "
          "FrictionControl");
    }
  } else {
    static_assert(holds_gravity<L>, "gravity nowhere: add GravityControl to the law");
  }
}
/// Compares the law's settings with the robot's description; throws `ConfigurationError` with both numbers.
template <class Robot, class L>
SKINCTL_COLD void check_settings(const Robot& robot, const L& law) {
  if constexpr (requires { robot.virtual_dynamics(); }) {
    const LawTerms<Robot::joints, typename Robot::scalar> terms{robot.longest_dt(), robot.virtual_dynamics(),
                                                                robot.loop_delay()};
    if constexpr (requires { law.check_for(terms); }) law.check_for(terms);
  }
}
/// Throws `ConfigurationError` for a lead beside a limit of jerk: it is extrapolated from velocities that the governor
/// then smooths, and the two swing.
template <class Resolver>
SKINCTL_COLD void check_no_lead(const Resolver& r) {
  const auto check = [](const auto& parameters) {
    require(parameters.lead == 0, "lead beside MaxJerk", 1e3 * static_cast<double>(parameters.lead), "0 ms");
  };
  if constexpr (has_one_interface<Resolver>) {
    check(r.parameters());
  } else {
    Resolver::each([&](auto k) { check(r.template parameters<k.value>()); });
  }
}
/// Checks that the stiffest contact that a description names comes to rest on this skin.
template <class Robot, class Skin>
SKINCTL_COLD void check_contacts(const Robot& robot, const Skin& skin) {
  if constexpr (requires { robot.parts(); }) {
    const auto check = [&]<class Part>(const Part& given_part) {
      if constexpr (std::is_same_v<typename Part::RobotPart, StiffestContactPart>)
        given_part.check(robot, skin);
    };
    std::apply([&](const auto&... given_part) { (check(given_part), ...); }, robot.parts());
  }
}
}  // namespace detail
SKINCTL_END_NAMESPACE
