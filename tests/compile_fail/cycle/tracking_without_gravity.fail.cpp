// expect: a tracking law without a gravity law beside it holds G\(q\): set needs.gravity
#include "skinctl/skinctl.hpp"

using namespace skinctl;

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
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, Push{});
}
