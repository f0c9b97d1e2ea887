// expect: this law lacks its Memory
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  int start(const auto&) const noexcept { return 0; }
  JointTorque<6> torque(int, const auto&) const noexcept { return {}; }
  int advance(int, const auto&, double, Opposition) const noexcept { return 0; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
