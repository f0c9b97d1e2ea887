// expect: does not return its Memory
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  double advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
