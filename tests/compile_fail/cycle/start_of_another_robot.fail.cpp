// expect: start\(known\) of this law is not const, or does not take what is known
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  Memory start(const State<7>&) const noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
