// expect: a joint is in no group
#ifdef SKINCTL_RIGHT
// A joint of its own interface is a group of its own.
#endif
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
auto robot(const RobotConfiguration<5>& arm, const RobotConfiguration<1>& wrist) {
  return by_groups(ur5::Model{}, position_joints<joints_between(0, 5)>(arm),
                   velocity_joints<0b100000>(wrist));
}
#else
auto robot(const RobotConfiguration<5>& arm) {
  return by_groups(ur5::Model{}, position_joints<joints_between(0, 5)>(arm));
}
#endif
