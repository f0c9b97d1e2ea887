// expect: a step changes its memory: no const one
// lines: 10
#include "tests/compile_fail/sound.hpp"

auto build() {
  const auto cycle = Cycle(sound_arm(), GravityControl{});
#ifdef SKINCTL_RIGHT
  auto memory = cycle.start(State<6>{});
#else
  const auto memory = cycle.start(State<6>{});
#endif
  const decltype(cycle)::Input input;
  return cycle.step(memory, input);
}
