// expect: this guard is for another interface
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms},
                             FrictionUncompensated{});
  return Cycle(arm, GravityControl{}, Guard<Interface::position, 6>(arm.configuration()));
}
