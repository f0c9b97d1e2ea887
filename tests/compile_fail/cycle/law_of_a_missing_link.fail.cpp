// expect: this law asks for a link that the robot does not have
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model>;

void build(const Robot& robot, const Guard<Interface::position, 6>& guard) {
  static_cast<void>(
      Cycle(robot, SkinCartesianControl<6>(Transform<Link<6>, Tool>()) + GravityControl{}, guard));
}
