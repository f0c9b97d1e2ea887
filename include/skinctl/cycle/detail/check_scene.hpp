// SPDX-License-Identifier: BSD-3-Clause
// Checks that a law and a skin are for the robot of a scene; one line of error where the scene is built.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/law/detail/check_law.hpp"
#include "skinctl/tactile/detail/touch_fault.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The model of the robot of the resolver `Robot`.
template <class Robot>
using model_of = std::remove_cvref_t<decltype(std::declval<const Robot&>().model())>;

/// In place of a wrong skin, after the error about it.
struct WrongSkin {
  using Wrenches = NoTouch;
  struct Memory {};
  template <class... X>
  constexpr WrongSkin(const X&...) noexcept {}
  [[nodiscard]] Memory start(Nanoseconds) const noexcept { return {}; }
  template <class... X>
  Status receive(Memory&, const X&...) const noexcept {
    return {};
  }
  [[nodiscard]] Wrenches wrenches(const Memory&) const noexcept { return {}; }
};

/// Faults of a skin for the robot of a scene.
enum class SkinFault { none, other_scalar, other_joints, other_model };
template <SkinFault F, class Skin>
struct SaySkin {
  using enum SkinFault;
  static_assert(F != other_scalar, "this skin is for a robot in another scalar");
  static_assert(F != other_joints, "this skin is for a robot with another number of joints");
  static_assert(
      F != other_model,
      "this skin is for another robot: its type names the model, as in ur5_skin<260, double, Model>()");
};
template <class Robot, class Skin>
consteval SkinFault fault_in_skin() {
  if constexpr (NamesModel<Skin>) {
    using Wrenches = typename Skin::Wrenches;
    using Other = typename Wrenches::model_type;
    if (!std::same_as<typename Wrenches::scalar, typename Robot::scalar>) return SkinFault::other_scalar;
    if (Other::joints != Robot::joints) return SkinFault::other_joints;
    return std::is_base_of_v<Other, model_of<Robot>> ? SkinFault::none : SkinFault::other_model;
  } else {
    return SkinFault::none;
  }
}

/// The first fault of a law in a scene.
template <class Robot, class L, class Skin>
constexpr auto find_in_scene() {
  constexpr auto members = find_in_members<L>();
  if constexpr (members.fault != LawFault::none) {
    return members;
  } else {
    constexpr auto robot = find_for_robot<L, Robot::joints, typename Robot::scalar>();
    if constexpr (robot.fault != LawFault::none) {
      return robot;
    } else {
      return find_in_functions<L, typename Robot::template Knows<L, typename Skin::Wrenches>, false>();
    }
  }
}
/// The valid parts of a scene; a placeholder without effect for each wrong one.
template <class Robot, class GivenLaw, class GivenSkin>
struct Scene {
  static constexpr SkinFault skin_fault = fault_in_skin<Robot, GivenSkin>();
  static constexpr TouchFault touch_fault = [] {
    if constexpr (skin_fault == SkinFault::none) {
      return fault_in_touch<GivenSkin, State<Robot::joints, typename Robot::scalar>>();
    } else {
      return TouchFault::none;  // the other fault is said
    }
  }();
  using Skin = std::conditional_t<skin_fault == SkinFault::none && touch_fault == TouchFault::none, GivenSkin,
                                  WrongSkin>;
  using Finding = decltype(find_in_scene<Robot, GivenLaw, Skin>());
  static constexpr LawFault law_fault = Finding::fault;
  using Law = std::conditional_t<law_fault == LawFault::none, GivenLaw, WrongLaw<GivenLaw>>;
  /// The type in which the constructor of a scene takes its law: of a wrong law the type that raises its
  /// error. (Clang adds lines where the type does not depend on a parameter of the constructor.)
  template <class>
  struct Argument {
    using type = std::conditional_t<law_fault == LawFault::none, const GivenLaw&,
                                    Say<law_fault, typename Finding::Law>>;
  };
  /// The argument as the law of the scene.
  template <class A>
  static decltype(auto) taken(const A& law) {
    if constexpr (law_fault == LawFault::none) {
      return (law);
    } else {
      return Law();
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
