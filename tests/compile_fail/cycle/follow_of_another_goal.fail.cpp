// expect: follow\(memory, known, goal\) of this law does not take its Goal
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Reach : StatelessLaw<Reach> {
  using Goal = JointGoal<6>;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  Received<Memory> receive(const Memory& m, const auto&, const Goal&) const noexcept { return {m, {}}; }
#ifdef SKINCTL_RIGHT
  Received<Memory> follow(const Memory& m, const auto&, const Goal&) const noexcept {
    return {m, {}};
  }
#else
  Received<Memory> follow(const Memory& m, const auto&, double) const noexcept { return {m, {}}; }
#endif
};

int main() {
  const auto arm = by_position(
      ur5::Model{},
      RobotConfiguration<6>{.limits = limits_of<ur5::Description>(), .period = 8ms, .delay = 8ms});
  static_cast<void>(Cycle(arm, Reach{} + GravityControl{}));
}
