// expect: RobotConfiguration<
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build(const JointLimits<7>& limits) {
  const auto arm = by_position(ur5::Model{}, {.limits = limits, .period = 8ms, .virtual_damping = 4});
  return Cycle(arm, GravityControl{});
}
