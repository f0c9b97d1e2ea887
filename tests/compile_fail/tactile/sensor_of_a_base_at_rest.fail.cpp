// expect: the robot is OnMovingBase, and the model of this sensor is not
// lines: 24
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const OnMovingBase robot{ur5::Model{}};
#ifdef SKINCTL_RIGHT
  const auto sensor = wrist_sensor<5>(robot);
#else
  const auto sensor = wrist_sensor<5>(ur5::Model{});
#endif
  const auto arm = by_position(
      robot,
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  const Cycle scene(arm, sensor, SkinJointControl{} + GravityControl{});
  auto memory = scene.start({});
  return scene.step(memory, {});
}
