// expect: status\(memory\) of this law is not const, or returns no Status
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  bool status(const Memory&) const noexcept { return true; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
