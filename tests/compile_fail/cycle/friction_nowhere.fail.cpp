// expect: friction nowhere: describe
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms});
  return Cycle(arm, SkinJointControl{} + GravityControl{});
}
