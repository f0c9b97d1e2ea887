// expect: a torque interface has no motion whose jerk
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
using Robot = ResolverBy<Interface::position, ur5::Model>;
#else
using Robot = ResolverBy<Interface::torque, ur5::Model>;
#endif

auto scene(const Robot& robot, const MaxJerk<6>& jerk) {
  return Cycle(robot, GravityControl{}).with(jerk);
}
