// expect: RobotHoldsGravity: only by torque
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{} + GravityControl{});
#else
  const auto arm = by_position(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4},
      RobotHoldsGravity{});
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{});
#endif
}
