// expect: contact limits need a skin on each link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

#ifdef SKINCTL_RIGHT
auto scene(const Robot& robot, const LinkContact<2>& contact,
           const Skin<ur5::Model, double, Patch<2, 10>>& skin) {
  return Cycle(robot, skin, GravityControl{}).with(contact);
}
#else
auto scene(const Robot& robot, const LinkContact<2>& contact) {
  return Cycle(robot, NoSkin{}, GravityControl{}).with(contact);
}
#endif
