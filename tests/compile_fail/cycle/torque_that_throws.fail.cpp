// expect: the torque of this law may throw in the loop: mark it noexcept
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  JointTorque<6> torque(const Memory&, const auto&) const { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
