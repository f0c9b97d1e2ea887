// Whether a law and a skin are for the robot of a scene: said in one line where the scene is built.
#pragma once

#include "skinctl/core/detail/check_law.hpp"
#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The model of the robot that `Robot`, a resolver, drives.
template <class Robot>
using model_of = std::remove_cvref_t<decltype(std::declval<const Robot&>().model())>;

/// Stands for a skin that is wrong, after the error about it.
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

template <class Skin>
concept HasWrenches = requires(const Skin& skin, const typename Skin::Memory& memory) {
  { skin.wrenches(memory) } -> std::same_as<typename Skin::Wrenches>;
};

/// Whether a skin has what a scene asks of it, and is for its robot.
template <class Robot, class Skin>
consteval bool skin_fits() {
  using T = typename Robot::scalar;
  if constexpr (!HasWrenches<Skin>) {
    static_assert(HasWrenches<Skin>, "a skin has Memory, Wrenches and wrenches(memory): is this one?");
    return false;
  } else if constexpr (!requires { typename Skin::Wrenches::model_type; }) {
    return true;
  } else {
    using Wrenches = typename Skin::Wrenches;
    constexpr bool scalar = std::same_as<typename Wrenches::scalar, T>;
    constexpr bool joints = Wrenches::model_type::joints == Robot::joints;
    constexpr bool model = std::same_as<typename Wrenches::model_type, model_of<Robot>>;
    static_assert(scalar, "this skin is for a robot in another scalar");
    static_assert(!scalar || joints, "this skin is for a robot with another number of joints");
    static_assert(
        !scalar || !joints || model,
        "this skin is for another robot: name the model in its type, as in ur5_skin<260, double, Model>()");
    return scalar && joints && model;
  }
}
template <class Robot, class Skin>
struct SkinOfScene {
  using type = std::conditional_t<skin_fits<Robot, Skin>(), Skin, WrongSkin>;
};
/// `Skin`, if it is for the robot; else an error that says why not, and a skin that feels nothing.
template <class Robot, class Skin>
using skin_of_scene = typename SkinOfScene<Robot, Skin>::type;

template <class Robot, class L, class Skin>
consteval bool law_fits() {
  if constexpr (!fits_robot<L, Robot::joints, typename Robot::scalar>()) {
    return false;
  } else {
    return all_run_with<L, typename Robot::template Knows<L, typename Skin::Wrenches>, false>();
  }
}
template <class Robot, class L, class Skin>
struct LawOfScene {
  using type = std::conditional_t<law_fits<Robot, L, Skin>(), L, WrongLaw<L>>;
};
template <class Robot, class L, class Skin>
struct LawOfScene<Robot, WrongLaw<L>, Skin> {
  using type = WrongLaw<L>;
};
/// `L`, if it is a law for the robot; else an error that says why not, and a law that does nothing.
template <class Robot, class L, class Skin>
using law_of_scene = typename LawOfScene<Robot, L, Skin>::type;

}  // namespace detail
SKINCTL_END_NAMESPACE
