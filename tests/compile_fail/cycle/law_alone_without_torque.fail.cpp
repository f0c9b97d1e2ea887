// expect: this law lacks torque
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::gravity;
  Memory start(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
#endif
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

auto build() {
  return Cycle(sound_arm(), Push{});
}
