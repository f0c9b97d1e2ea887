// expect: this law asks for a link that the robot does not have
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), SkinCartesianControl<5>(Transform<Link<5>, Tool>()) + GravityControl{});
#else
  return Cycle(sound_arm(), SkinCartesianControl<6>(Transform<Link<6>, Tool>()) + GravityControl{});
#endif
}
