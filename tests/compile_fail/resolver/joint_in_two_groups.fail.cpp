// expect: a joint is in two groups
// lines: 10
// Groups name joints by bits: 3 is the joints 0 and 1, not the first three.
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto robot(const RobotConfiguration<2>& two, const RobotConfiguration<4>& four,
           const RobotConfiguration<5>& five) {
#ifdef SKINCTL_RIGHT
  return by_groups(ur5::Model{}, position_joints<0b000011>(two), torque_joints<0b111100>(four));
#else
  return by_groups(ur5::Model{}, position_joints<3>(two), torque_joints<0b111101>(five));
#endif
}
