// expect: joints
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), SplineJoint(sound_arm()));
#else
  return Cycle(sound_arm(), SplineJoint<7>({}));
#endif
}
