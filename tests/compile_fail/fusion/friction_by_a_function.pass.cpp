#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  static constexpr bool compensates_friction = true;
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
