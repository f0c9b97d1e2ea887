// expect: limits of another number of joints than the robot has|RobotConfiguration<
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
auto build(const JointLimits<6>& limits) {
#else
auto build(const JointLimits<7>& limits) {
#endif
  const auto arm = by_position(ur5::Model{}, {.limits = limits, .period = 8ms, .virtual_damping = 4});
  return Cycle(arm, GravityControl{});
}
