// expect: this guard is for a robot in another scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, GravityControl{},
               Guard<Interface::position, 6, float>(
                   {.limits = limits_of<ur5::Description, float>(15.0f), .period = 8ms}));
}
