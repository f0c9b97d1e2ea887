// expect: contact limits need a skin on each link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto scene(const Robot& robot, const Guard<Interface::position, 6>& guard, const LinkContact<2>& contact) {
  return Cycle(robot, NoSkin{}, GravityControl{}, guard,
               make_governor(robot.limits(), contact_limits(robot.model(), contact)));
}
