// expect: by torque no virtual robot runs ahead: leave PassivityObserver
// lines: 10
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto build() {
  const RobotConfiguration<6> configuration{.limits = limits_of<ur5::Description>(15.0), .period = 2ms};
#ifdef SKINCTL_RIGHT
  return by_torque(ur5::Model{}, configuration, RobotCompensatesFriction{}, EnergyTank{});
#else
  return by_torque(ur5::Model{}, configuration, RobotCompensatesFriction{}, EnergyTank{},
                   PassivityObserver{});
#endif
}
