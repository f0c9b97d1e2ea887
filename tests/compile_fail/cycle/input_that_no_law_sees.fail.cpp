// expect: this law has an Input, but lacks see\(memory, input, seen\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Lamp {
  bool on = false;
};
struct Glow : StatelessLaw<Glow> {
  using Input = Lamp;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
#ifdef SKINCTL_RIGHT
  Status see(Memory&, const Lamp&, const auto&) const noexcept { return {}; }
#else
  // nothing reads the lamp
#endif
};

int main() {
  static_cast<void>(Glow{} + GravityControl{});
}
