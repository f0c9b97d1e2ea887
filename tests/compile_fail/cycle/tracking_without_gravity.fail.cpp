// expect: a tracking law without a gravity law beside it holds G\(q\): set needs.gravity
#include "tests/compile_fail/sound.hpp"

struct Push : Composable {
  struct Memory {};
#ifdef SKINCTL_RIGHT
  static constexpr Needs needs = {.gravity = true};
#else
  static constexpr Needs needs = {};
#endif
  static constexpr LawRole role = LawRole::tracking;
  Memory start(const auto&) const noexcept { return {}; }
  TorqueParts<6> parts(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

auto build() {
  return Cycle(sound_arm(), Push{});
}
