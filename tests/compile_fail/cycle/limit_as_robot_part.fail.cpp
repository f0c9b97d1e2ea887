// expect: behind the configuration stand parts of a description
// lines: 10
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const RobotConfiguration<6> configuration{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4};
#ifdef SKINCTL_RIGHT
  return by_position(ur5::Model{}, configuration, EnergyTank{});
#else
  return by_position(ur5::Model{}, configuration, MaxToolSpeed<5>{.speed = 0.25, .reach = 1.2});
#endif
}
