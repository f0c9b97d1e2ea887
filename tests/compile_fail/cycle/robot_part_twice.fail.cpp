// expect: a part of a robot.s description is given twice
// lines: 10
#include "tests/compile_fail/sound.hpp"

auto build() {
  const RobotConfiguration<6> configuration{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
#ifdef SKINCTL_RIGHT
  return by_position(ur5::Model{}, configuration, EnergyTank{});
#else
  return by_position(ur5::Model{}, configuration, EnergyTank{}, EnergyTank{});
#endif
}
