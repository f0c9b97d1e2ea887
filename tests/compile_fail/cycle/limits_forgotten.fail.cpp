// expect: RobotConfiguration<
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(ur5::Model{}, {.period = 8ms, .virtual_damping = 4});
  return Cycle(arm, GravityControl{});
}
