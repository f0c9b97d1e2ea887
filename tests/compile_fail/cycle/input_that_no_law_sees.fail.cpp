// expect: this law has an Input, but lacks see\(memory, input, seen\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Lamp {
  bool on = false;
};
struct Glow : StatelessLaw<Glow> {
  using Input = Lamp;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  // nothing reads the lamp
};

int main() {
  static_cast<void>(Glow{} + GravityControl{});
}
