// expect: this skin is for a robot with another number of joints
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(),
               Skin<ur5::Model, double, Patch<0, 1>>(Patch<0, 1>(std::vector<PlacedCell<0>>{{1, {}}})),
               SkinJointControl{} + GravityControl{});
#else
  return Cycle(
      sound_arm(),
      Skin<ur5_allegro::Model<>, double, Patch<0, 1>>(Patch<0, 1>(std::vector<PlacedCell<0>>{{1, {}}})),
      SkinJointControl{} + GravityControl{});
#endif
}
