// expect: a torque interface has no motion whose jerk
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::torque, ur5::Model>;

auto scene(const Robot& robot, const MaxJerk<6>& jerk) {
  return Cycle(robot, GravityControl{}).with(jerk);
}
