// expect: this law asks for a link that the robot does not have
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, SkinCartesianControl<5>(Transform<Link<5>, Tool>()) + GravityControl{});
#else
  return Cycle(arm, SkinCartesianControl<6>(Transform<Link<6>, Tool>()) + GravityControl{});
#endif
}
