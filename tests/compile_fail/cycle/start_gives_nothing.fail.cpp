// expect: does not return its Memory
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  double start(const auto&) const noexcept { return 0; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
