// expect: torque\(memory, known\) of this law is not const
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifndef SKINCTL_RIGHT
  JointTorque<6> torque(const Memory&, const auto&) noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Push{} + GravityControl{});
}
