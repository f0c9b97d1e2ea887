// expect: a time has a unit: 4ms|RobotConfiguration<
// lines: 10
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
#ifdef SKINCTL_RIGHT
  return by_position(ur5::Model{},
                     {.limits = limits_of<ur5::Description>(15.0), .period = 4ms, .virtual_damping = 4});
#else
  return by_position(ur5::Model{},
                     {.limits = limits_of<ur5::Description>(15.0), .period = 0.004, .virtual_damping = 4});
#endif
}
