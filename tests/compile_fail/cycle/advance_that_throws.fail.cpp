// expect: advance\(\.\.\.\) of this law may throw in the loop: mark it noexcept
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  Memory advance(const Memory&, const auto&, double, Opposition) const { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
