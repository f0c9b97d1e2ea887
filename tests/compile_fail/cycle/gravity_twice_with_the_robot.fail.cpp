// expect: gravity twice: the robot holds it
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms},
                             RobotHoldsGravity{}, FrictionUncompensated{});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{});
#else
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{} + GravityControl{});
#endif
}
