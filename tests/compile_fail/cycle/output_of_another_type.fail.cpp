// expect: output\(memory\) of this law
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Lamp {
  bool on = false;
};
struct Glow : StatelessLaw<Glow> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  using Output = Lamp;
#ifdef SKINCTL_RIGHT
  Lamp output(const Memory&) const noexcept { return {}; }
#else
  bool output(const Memory&) const noexcept { return true; }
#endif
};

int main() {
  static_cast<void>(Glow{} + GravityControl{});
}
