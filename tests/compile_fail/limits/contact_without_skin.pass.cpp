#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = ResolverBy<Interface::position, ur5::Model>;

auto scene(const Robot& robot, const LinkContact<2>& contact,
           const Skin<ur5::Model, double, Patch<2, 10>>& skin) {
  return Cycle(robot, skin, GravityControl{}).with(contact);
}
