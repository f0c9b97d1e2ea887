#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto scene(const Robot& robot, const Guard<Interface::position, 6>& guard, const JerkLimits<6>& jerk) {
  return Cycle(robot, GravityControl{}, guard, make_governor(robot.limits(), jerk));
}
