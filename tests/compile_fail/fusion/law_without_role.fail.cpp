// expect: this law lacks its role
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
#ifdef SKINCTL_RIGHT
  static constexpr LawRole role = LawRole::reactive;
#endif
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
