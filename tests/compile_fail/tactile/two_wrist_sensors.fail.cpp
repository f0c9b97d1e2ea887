// expect: two sensors of one kind
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4});
  const auto sensor = wrist_sensor<5>(ur5::Model{});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, sensor, SkinJointControl{} + GravityControl{});
#else
  return Cycle(arm, sensor + wrist_sensor<3>(ur5::Model{}), SkinJointControl{} + GravityControl{});
#endif
}
