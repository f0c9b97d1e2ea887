#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms});
  const FrictionControl<6> friction(JointFriction<6>(JointFriction<6>::Settings{}));
  return Cycle(arm, friction + GravityControl{});
}
