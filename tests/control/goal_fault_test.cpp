// Promise: a refused goal names its joint or coordinate, with its value and the allowed range
// Tried: joints beyond a limit, NaN, axes that are no rotation, a duration below zero, a goal that is too fast

#include "skinctl/control/goal_fault.hpp"

#include <doctest/doctest.h>

#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/operational_control.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// What is said of a goal that `scene` refuses.
template <class Scene, class Goal>
std::string said(const Scene& scene, const Goal& goal) {
  const State<6> at{0ns, home_position(), {}};
  auto memory = scene.start(at);
  typename Scene::Input input;
  input.now = input.measured.time = 8ms;
  input.measured.q = at.q;
  input.goal = goal;
  CHECK(scene.step(memory, input).status.has(Reason::goal_refused));
  return in_words(goal_fault(scene, goal));
}
Transform<Base, Tool> tool_at_home() {
  return link_poses(ur5::Model{}, home_position()).get<5>() * Transform<Link<5>, Tool>();
}
}  // namespace

TEST_CASE("goal fault: the joint, its value and its range") {
  const auto robot = test_robot<Interface::position, double>({});
  auto settings = tracking_settings(robot);
  settings.reach = GoalPolicy::refuse;
  const Cycle scene(robot, SplineJoint<6>(settings));
  const auto home_with = [](std::size_t i, double q) {
    auto all = home_position();
    all[i] = q;
    return all;
  };
  CHECK(said(scene, JointGoal<6>{home_with(2, 90), 1s}) ==
        "position of joint 2: 90 rad or m, allowed: -3.14159 to 3.14159");
  CHECK(said(scene, JointGoal<6>{home_with(5, no_number), 1s}) ==
        "position of joint 5: nan rad or m, allowed: -6.28319 to 6.28319");
  CHECK(said(scene, JointGoal<6>{home_position(), -1s}) == "duration: -1 s, allowed: 0 or more");
  CHECK(said(scene, JointGoal<6>{home_with(0, 3), 1ms}) ==
        "every number is in its range: too fast for the law's largest speed, or no law takes it now");

  const Cycle target(robot, JointControl<6>(robot));
  CHECK(said(target, JointReference<6>{home_with(1, -7), {}, {}}) ==
        "position of joint 1: -7 rad or m, allowed: -6.28319 to 6.28319");
  CHECK(said(target,
             JointReference<6>{home_position(), JointVelocity<6>{0.0, no_number, 0.0, 0.0, 0.0, 0.0}, {}}) ==
        "velocity of joint 1: nan, allowed: any finite number");
}

TEST_CASE("goal fault: the coordinate of a pose") {
  const auto robot = test_robot<Interface::position, double>({});
  const Cycle scene(robot, SplineOperational<6, 5>(robot, Transform<Link<5>, Tool>()));
  CHECK(said(scene, PoseGoal<Tool>{Transform<Base, Tool>::translation_xyz(0.3, no_number, 0.2), 1s}) ==
        "origin y: nan m, allowed: any finite number");
  const Cycle target(robot, OperationalControl<6, 5>(robot, Transform<Link<5>, Tool>()));
  PoseReference<Tool> moving{tool_at_home(), {}, {}};
  moving.V.angular.y = no_number;
  CHECK(said(target, moving) == "velocity: nan, allowed: any finite number");
  const Rotation<double> stretched{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK(said(scene, PoseGoal<Tool>{Transform<Base, Tool>(stretched, {0.3, 0.1, 0.2}), 1s}) ==
        "axes, |R'R - 1|: 3, allowed: 0 to 0.002");
}
