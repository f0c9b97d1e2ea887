// expect: friction nowhere: describe
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms},
                             RobotCompensatesFriction{});
#else
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms});
#endif
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{} + GravityControl{});
}
