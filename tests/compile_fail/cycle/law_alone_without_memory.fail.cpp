// expect: this law lacks its Memory
#include "skinctl/skinctl.hpp"

using namespace skinctl;

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
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, Push{});
}
