// expect: contact limits need a skin on each link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto scene(const Robot& robot, const LinkContact<2>& contact) {
  return Cycle(robot, NoSkin{}, GravityControl{}).with(contact);
}
