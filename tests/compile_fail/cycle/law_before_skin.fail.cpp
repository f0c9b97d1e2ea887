// expect: order: robot, skin, law
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, ur5_skin<260>(), SkinJointControl{} + GravityControl{});
#else
  return Cycle(arm, SkinJointControl{} + GravityControl{}, ur5_skin<260>());
#endif
}
