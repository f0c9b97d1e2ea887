// expect: does not take its Goal
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
  using Goal = double;
#ifdef SKINCTL_RIGHT
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept {
    return {memory, {}};
  }
#else
  Received<Memory> receive(const Memory& memory, const auto&, const char*) const noexcept {
    return {memory, {}};
  }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
