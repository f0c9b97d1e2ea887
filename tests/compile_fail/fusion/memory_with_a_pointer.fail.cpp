// expect: the Memory of this law holds a pointer
// lines: 10
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
  struct Memory {
    double pushed = 0;
#ifdef SKINCTL_RIGHT
    std::uint32_t shared = 0;
#else
    const double* shared = nullptr;
#endif
  };
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory& memory, const auto&, double, Opposition) const noexcept { return memory; }
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
