// expect: this law has a Goal, but lacks receive
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
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept { return {memory, {}}; }
#endif
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
