// expect: torque.memory, known. of this law is not const, or does not take
// lines: 10
#include "tests/compile_fail/sound.hpp"

struct Putty : SoundLaw {
  struct Memory {
    double r = 0;
  };
  Memory start(const auto&) const noexcept { return {}; }
  Memory advance(const Memory& m, const auto&, double, Opposition) const noexcept { return m; }
#ifdef SKINCTL_RIGHT
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
#else
  JointTorque<6> torque(const auto&, const Memory&) const noexcept { return {}; }
#endif
};

auto build() {
  return Cycle(sound_arm(), Putty{} + GravityControl{});
}
