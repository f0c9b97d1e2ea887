// expect: this law lacks start\(known\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
#ifdef SKINCTL_RIGHT
  Memory start(const auto&) const noexcept { return {}; }
#endif
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
