// expect: torque\(memory, known\) of this law is not const
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
#else
  JointTorque<6> torque(const Memory&, const auto&) noexcept { return {}; }
#endif
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, Push{} + GravityControl{});
}
