// expect: this skin is for another robot
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), ur5_skin<260>(), SkinJointControl{} + GravityControl{});
#else
  return Cycle(sound_arm(), ur5_skin<260, double, ur3e::Model>(), SkinJointControl{} + GravityControl{});
#endif
}
