#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/skinctl.hpp"

using namespace skinctl;
using namespace skinctl::behaviour;

namespace {
const SplineJoint<6> spline({.dt = 2ms});
const JointControl<6> joint({.dt = 2ms});
}  // namespace

TEST_CASE("skill_set: takes the skills whose controllers are there, with those that follow them") {
  const auto all = boost::hana::union_(figure_7, section_6);
  const auto set = skill_set<ReachJoint>(all, {}, skill_controller<controller::SkinJoint>(SkinJointControl{}),
                                         skill_controller<controller::Joint>(joint),
                                         skill_controller<controller::Gravity>(GravityControl{}),
                                         skill_controller<controller::SplineJoint>(spline));
  using Set = std::remove_const_t<decltype(set)>;
  // Squeezing's own controllers are there, but not the force control that follows it.
  static_assert(Set::skills == 3);
  static_assert(Set::index<ReachJoint>() == 0);
  const auto& reach = set.skill<ReachJointGoal>();
  CHECK(reach.weights == std::array<double, 4>{1, 0, 1, 1});
  CHECK(reach.controllers == 3);
  CHECK(
      (reach.order[0] == 2 && reach.order[1] == 0 && reach.order[2] == 3));  // gravity, skin, then what moves
  CHECK(reach.next == Set::index<ReachJointGoal>());
  CHECK(reach.conditions.finish == SkillFinish::settled);

  CHECK(describe(set.sum(), reach.weights) == "skin_joint + gravity + spline_joint");
  CHECK(describe(set.sum(), set.skill<KinestheticJoint>().weights) == "skin_joint + gravity");
}
