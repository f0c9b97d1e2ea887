// expect: compensates_friction of this law is no .static constexpr bool
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  static constexpr bool compensates_friction = true;
#else
  bool compensates_friction() const noexcept { return true; }
#endif
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
