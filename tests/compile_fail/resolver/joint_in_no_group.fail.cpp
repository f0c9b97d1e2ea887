// expect: a joint is in no group
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto robot(const RobotConfiguration<5>& arm) {
  return by_groups(ur5::Model{}, position_joints<joints_between(0, 5)>(arm));
}
