// expect: this skin is for a robot with another number of joints
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
#ifdef SKINCTL_RIGHT
  return Cycle(arm, Skin<ur5::Model, double, Patch<0, 1>>(Patch<0, 1>(std::vector<PlacedCell<0>>{{1, {}}})),
               SkinJointControl{} + GravityControl{});
#else
  return Cycle(
      arm, Skin<ur5_allegro::Model<>, double, Patch<0, 1>>(Patch<0, 1>(std::vector<PlacedCell<0>>{{1, {}}})),
      SkinJointControl{} + GravityControl{});
#endif
}
