// expect: this law is for a robot in another scalar
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), SplineJoint<6>({.dt = 8ms}) + GravityControl{});
#else
  return Cycle(sound_arm(), SplineJoint<6, float>({.dt = 8ms}) + GravityControl{});
#endif
}
