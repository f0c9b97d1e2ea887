// SPDX-License-Identifier: BSD-3-Clause
// The controllers and behaviours of the paper by name, and the recipes of the behaviours: Fig. 7, section 6.
#pragma once

#include <array>

#include "skinctl/core/detail/hana.hpp"
#include "skinctl/skills/skill.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Names of controllers, the columns of Fig. 7. A set of skills assigns a law to each of them.
namespace controller {
struct Joint {};              ///< Joint Control
struct SplineJoint {};        ///< Spline Joint Control
struct Operational {};        ///< Cartesian (Operational) Control
struct SplineOperational {};  ///< Spline Cartesian Control
struct SkinJoint {};          ///< Skin Joint Control
struct SkinCartesian {};      ///< Skin Cartesian Control
struct Gravity {};            ///< G Control
struct Force {};              ///< force control in Cartesian space, for section 6
struct Velocity {};           ///< Velocity Control
}  // namespace controller

/// Names of behaviours: the rows of Fig. 7, and the activities of section 6.
namespace behaviour {
struct KinestheticJoint {
  static constexpr const char* name = "kinesthetic_joint";
};
struct KinestheticCartesian {
  static constexpr const char* name = "kinesthetic_cartesian";
};
struct ReachJoint {
  static constexpr const char* name = "reach_joint";
};
struct ReachJointGoal {
  static constexpr const char* name = "reach_joint_goal";
};
struct ReachCartesian {
  static constexpr const char* name = "reach_cartesian";
};
struct ReachCartesianGoal {
  static constexpr const char* name = "reach_cartesian_goal";
};
struct Reaching {
  static constexpr const char* name = "reaching";
};
struct Putting {
  static constexpr const char* name = "putting";
};
struct Squeezing {  ///< first step: the gripper closes, the arm holds; then `ForceCartesian`
  static constexpr const char* name = "squeezing";
};
struct ForceCartesian {
  static constexpr const char* name = "force_cartesian";
};
}  // namespace behaviour

/// One controller of a recipe, and its weight in the sum.
template <class C>
struct Load {
  double weight = 1;
};
template <class C>
[[nodiscard]] constexpr Load<C> load(double weight = 1) noexcept {
  return {weight};
}

/// The controllers of a behaviour, in the order in which they load, and its conditions; `Next` follows when
/// it is finished, `void`: none.
template <class Next, class... C>
struct SkillRecipe {
  std::array<double, sizeof...(C)> weights;
  SkillSwitches switches;
  SkillConditions conditions;
  bool grips = false;
  GripperGoal grip{};

  [[nodiscard]] constexpr SkillRecipe when(const SkillConditions& c) const noexcept {
    return {weights, switches, c, grips, grip};
  }
  [[nodiscard]] constexpr SkillRecipe switching(const SkillSwitches& s) const noexcept {
    return {weights, s, conditions, grips, grip};
  }
  /// The recipe that gives the gripper of the set this goal when the skill starts, unless the request brings
  /// one.
  [[nodiscard]] constexpr SkillRecipe gripping(const GripperGoal& goal) const noexcept {
    return {weights, switches, conditions, true, goal};
  }
  /// The recipe followed by `N`.
  template <class N>
  [[nodiscard]] constexpr SkillRecipe<N, C...> then() const noexcept {
    return {weights, switches, conditions, grips, grip};
  }
};
template <class... C>
[[nodiscard]] constexpr SkillRecipe<void, C...> recipe(const Load<C>&... controllers) noexcept {
  return {{controllers.weight...}, {}, {}, false, {}};
}

/// An entry of a library, which is a map of Hana from behaviours to recipes.
template <class Behaviour, class R>
[[nodiscard]] constexpr auto skill(const R& recipe) noexcept {
  return boost::hana::make_pair(boost::hana::type_c<Behaviour>, recipe);
}

namespace detail {
inline constexpr SkillConditions until_settled{.finish = SkillFinish::settled, .timeout = 60s};
}

/// The behaviours of Fig. 7. The paper lists controllers in the order in which they load, those that hold the
/// robot last; here they come first, so that nothing acts before gravity is compensated and the skin gives
/// way.
inline constexpr auto figure_7 = boost::hana::make_map(
    skill<behaviour::KinestheticJoint>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>())),
    skill<behaviour::KinestheticCartesian>(
        recipe(load<controller::Gravity>(), load<controller::SkinCartesian>())),
    skill<behaviour::ReachJoint>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Joint>())),
    skill<behaviour::ReachJointGoal>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::SplineJoint>())
            .when(detail::until_settled)),
    skill<behaviour::ReachCartesian>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Operational>())),
    skill<behaviour::ReachCartesianGoal>(recipe(load<controller::Gravity>(),
                                                load<controller::SkinCartesian>(),
                                                load<controller::SplineOperational>())
                                             .when(detail::until_settled)));

/// The activities of section 6: `Reaching` and `Putting` = ReachCartGoal [SplineOpCtrl, SkinJointCtrl,
/// GCtrl], `Squeezing` = Close => ForceCart [CloseCtrl(D)] => [force control, SkinJointCtrl]. Gravity is
/// compensated throughout. Gripper 0 opens before `Reaching` and closes to squeeze.
inline constexpr auto section_6 = boost::hana::make_map(
    skill<behaviour::Reaching>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>(),
                                      load<controller::SplineOperational>())
                                   .switching(opened())
                                   .when(detail::until_settled)),
    skill<behaviour::Putting>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>(),
                                     load<controller::SplineOperational>())
                                  .when(detail::until_settled)),
    skill<behaviour::Squeezing>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::SplineJoint>())
            .switching(closed())
            .when({.finish = SkillFinish::switched, .hold = 500ms, .timeout = 5s})
            .then<behaviour::ForceCartesian>()),
    skill<behaviour::ForceCartesian>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Force>())
            .when({.needs = closed()})));

SKINCTL_END_NAMESPACE
