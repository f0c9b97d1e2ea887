// expect: gravity nowhere: add GravityControl
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), SkinJointControl{} + GravityControl{});
#else
  return Cycle(sound_arm(), SkinJointControl{});
#endif
}
