// expect: this law is for a robot with another number of joints
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, SplineJoint<6>({.dt = 8ms}) + GravityControl{});
#else
  return Cycle(arm, SplineJoint<7>({.dt = 8ms}) + GravityControl{});
#endif
}
