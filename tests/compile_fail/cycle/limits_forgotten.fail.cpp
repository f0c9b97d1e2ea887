// expect: RobotConfiguration<
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(ur5::Model{}, {.period = 8ms});
  return Cycle(arm, GravityControl{});
}
