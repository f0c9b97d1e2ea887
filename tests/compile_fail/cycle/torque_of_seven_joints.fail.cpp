// expect: the torque of this law is not a JointTorque
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  JointTorque<7> torque(const Memory&, const auto&) const noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
