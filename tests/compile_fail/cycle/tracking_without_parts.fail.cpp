// expect: a tracking law in a sum gives its parts
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::tracking;
  Memory start(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  TorqueParts<6> parts(const Memory&, const auto&) const noexcept { return {}; }
#else
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
#endif
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
