// expect: this skin is for a robot in another scalar
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), ur5_skin<260>(), SkinJointControl{} + GravityControl{});
#else
  return Cycle(sound_arm(), ur5_skin<260, float>(), SkinJointControl{} + GravityControl{});
#endif
}
