// expect: status\(memory\) of this law is not const, or returns no Status
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : StatelessLaw<Push> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  Status status(const Memory&) const noexcept { return {}; }
#else
  bool status(const Memory&) const noexcept { return true; }
#endif
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
