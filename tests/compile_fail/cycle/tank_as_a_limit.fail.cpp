// expect: with: takes settings of limits
// lines: 10
#include "tests/compile_fail/sound.hpp"

auto build() {
  const auto cycle = Cycle(sound_arm(), GravityControl{});
#ifdef SKINCTL_RIGHT
  return cycle.with(MaxToolSpeed<5>{.speed = 0.25, .reach = 1.2});
#else
  return cycle.with(EnergyTank{});
#endif
}
