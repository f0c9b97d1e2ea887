// expect: advance\(memory, known, dt, opposition\) of this law is not const, or does not take these
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
#else
  Memory advance(const Memory&, const auto&, double) const noexcept { return {}; }
#endif
};

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, Push{} + GravityControl{});
}
