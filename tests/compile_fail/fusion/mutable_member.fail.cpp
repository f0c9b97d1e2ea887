// expect: this law has a mutable member
// lines: 10
#include "tests/compile_fail/sound.hpp"

struct Brake : StatelessLaw<Brake> {
  double gain = 1;
#ifdef SKINCTL_RIGHT
  double most = 1;
#else
  mutable double last = 0;
#endif
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
};

auto build() {
  return Cycle(sound_arm(), ur5_skin<260>({.force = 20}), SkinJointControl{} + Brake{} + GravityControl{});
}
