// expect: advance\(\.\.\.\) of this law may throw in the loop: mark it noexcept
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr Role role = Role::reactive;
  Memory start(const auto&) const noexcept { return {}; }
  JointTorque<6> torque(const Memory&, const auto&) const noexcept { return {}; }
  Memory advance(const Memory&, const auto&, double, Opposition) const { return {}; }
};

using Robot = Resolver<Interface::position, ur5::Model>;

void build(const Robot& robot, const Guard<Interface::position, 6>& guard) {
  static_cast<void>(Cycle(robot, Push{} + GravityControl{}, guard));
}
