// expect: does not take its Goal
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
  using Goal = double;
#ifdef SKINCTL_RIGHT
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept {
    return {memory, {}};
  }
#else
  Received<Memory> receive(const Memory& memory, const auto&, const char*) const noexcept {
    return {memory, {}};
  }
#endif
};

auto build() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, Push{} + GravityControl{});
}
