// A joint of its own interface is a group of its own.
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto robot(const RobotConfiguration<5>& arm, const RobotConfiguration<1>& wrist) {
  return by_groups(ur5::Model{}, position_joints<joints_between(0, 5)>(arm),
                   velocity_joints<0b100000>(wrist));
}
