// expect: this law lacks advance\(memory, known, dt, opposition\)
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
#endif
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
