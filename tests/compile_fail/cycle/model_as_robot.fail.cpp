// expect: a model is no robot yet: by_position
// lines: 10
#include "tests/compile_fail/sound.hpp"

auto build() {
#ifdef SKINCTL_RIGHT
  return Cycle(sound_arm(), GravityControl{});
#else
  return Cycle(ur5::Model{}, GravityControl{});
#endif
}
