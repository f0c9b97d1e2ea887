// expect: friction twice: the robot compensates it
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms});
#else
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms},
                             RobotCompensatesFriction{});
#endif
  const FrictionControl<6> friction(JointFriction<6>(JointFriction<6>::Settings{}));
  return Cycle(arm, friction + GravityControl{});
}
