// expect: see\(memory, input, seen\) of this law is not const
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
  void see(Memory&, const Lamp&, const auto&) const noexcept {}
#endif
};

int main() {
  const auto arm = by_position(
      ur5::Model{},
      RobotConfiguration<6>{.limits = limits_of<ur5::Description>(), .period = 8ms, .delay = 8ms});
  static_cast<void>(Cycle(arm, Glow{} + GravityControl{}));
}
