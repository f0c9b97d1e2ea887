#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Lamp {
  bool on = false;
};
struct Glow : StatelessLaw<Glow> {
  using Input = Lamp;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  Status see(Memory&, const Lamp&, const auto&) const noexcept { return {}; }
};

int main() {
  static_cast<void>(Glow{} + GravityControl{});
}
