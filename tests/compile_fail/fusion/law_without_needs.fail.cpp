// expect: this law lacks its needs
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
#ifdef SKINCTL_RIGHT
  static constexpr Needs needs = {};
#endif
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
