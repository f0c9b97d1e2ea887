// expect: period|Nanoseconds|conver
// lines: 12
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  const auto arm = by_position(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 4ms, .virtual_damping = 4});
#else
  const auto arm = by_position(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 4, .virtual_damping = 4});
#endif
  return Cycle(arm, GravityControl{});
}
