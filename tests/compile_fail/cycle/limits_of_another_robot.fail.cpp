// expect: limits|JointLimits|conver
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(ur5::Model{}, {.limits = limits_of<allegro::Description>(), .period = 8ms});
  return Cycle(arm, GravityControl{});
}
