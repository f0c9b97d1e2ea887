// expect: the Memory of this law is not trivially copyable
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {
#ifdef SKINCTL_RIGHT
    char text[8];
#else
    std::string text;
#endif
  };
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
