#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  Status status(const Memory&) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
