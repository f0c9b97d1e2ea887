// expect: this law is for a robot with another number of joints
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), SplineJoint<6>({.dt = 8ms}) + GravityControl{});
#else
  return Cycle(sound_arm(), SplineJoint<7>({.dt = 8ms}) + GravityControl{});
#endif
}
