// expect: settled\(memory, known, still\) of this law
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Reach : StatelessLaw<Reach> {
  using Goal = JointGoal<6>;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  Received<Memory> receive(const Memory& m, const auto&, const Goal&) const noexcept { return {m, {}}; }
#ifdef SKINCTL_RIGHT
  bool settled(const Memory&, const auto&, double) const noexcept { return true; }
#else
  bool settled(const Memory&, const auto&) const noexcept { return true; }
#endif
};

int main() {
  const auto arm = by_position(
      ur5::Model{},
      RobotConfiguration<6>{.limits = limits_of<ur5::Description>(), .period = 8ms, .delay = 8ms});
  static_cast<void>(Cycle(arm, Reach{} + GravityControl{}));
}
