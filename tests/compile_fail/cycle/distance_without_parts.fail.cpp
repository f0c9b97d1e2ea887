// expect: distance\(known, goal\) of this law does not return position, orientation and joint
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Reach : StatelessLaw<Reach> {
  using Goal = JointGoal<6>;
  JointTorque<6> torque(const auto&) const noexcept { return {}; }
  Received<Memory> receive(const Memory& m, const auto&, const Goal&) const noexcept { return {m, {}}; }
#ifdef SKINCTL_RIGHT
  struct Distance {
    double position, orientation, joint;
  };
  Distance distance(const auto&, const Goal&) const noexcept { return {}; }
#else
  double distance(const auto&, const Goal&) const noexcept { return 0; }
#endif
};

int main() {
  const auto arm = by_position(
      ur5::Model{},
      RobotConfiguration<6>{.limits = limits_of<ur5::Description>(), .period = 8ms, .delay = 8ms});
  static_cast<void>(Cycle(arm, Reach{} + GravityControl{}));
}
