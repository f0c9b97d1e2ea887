#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Lamp {
  bool on = false;
};
struct Glow : StatelessLaw<Glow> {
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  using Output = Lamp;
  Lamp output(const Memory&) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Glow{} + GravityControl{});
}
