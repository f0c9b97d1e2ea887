// expect: this law receives goals, but does not name their type
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  using Goal = double;
#endif
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept { return {memory, {}}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
