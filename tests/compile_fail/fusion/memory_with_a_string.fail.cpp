// expect: the Memory of this law is not trivially copyable
// lines: 10
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
  struct Memory {
#ifdef SKINCTL_RIGHT
    char text[8];
#else
    std::string text;
#endif
  };
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
