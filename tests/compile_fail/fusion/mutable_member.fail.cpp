// expect: this law has a mutable member
// lines: 14
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Brake : StatelessLaw<Brake> {
  double gain = 1;
#ifdef SKINCTL_RIGHT
  double most = 1;
#else
  mutable double last = 0;
#endif
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
};

int main() {
  static_cast<void>(SkinJointControl{} + Brake{} + GravityControl{});
}
