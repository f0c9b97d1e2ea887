// expect: this guard is for a robot with another number of joints
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build(const RobotConfiguration<7>& other) {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, GravityControl{}, Guard<Interface::position, 7>(other));
}
