// expect: advance\(memory, known, dt, opposition\) of this law is not const, or does not take these
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  Memory advance(const Memory&, const auto&, double) const noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
