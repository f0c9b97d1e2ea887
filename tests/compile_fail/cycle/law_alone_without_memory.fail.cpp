// expect: this law lacks its Memory
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
#ifdef SKINCTL_RIGHT
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::gravity;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
#else
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::gravity;
  int start(const auto&) const noexcept { return 0; }
  JointTorque<6> torque(int, const auto&) const noexcept { return {}; }
  int advance(int, const auto&, double, Opposition) const noexcept { return 0; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{});
}
