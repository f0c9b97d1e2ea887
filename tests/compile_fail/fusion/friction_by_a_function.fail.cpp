// expect: compensates_friction of this law is no .static constexpr bool
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  bool compensates_friction() const noexcept { return true; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
