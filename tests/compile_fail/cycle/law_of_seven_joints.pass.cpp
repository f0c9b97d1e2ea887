#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model>;

void build(const Robot& robot, const Guard<Interface::position, 6>& guard) {
  static_cast<void>(Cycle(robot, SplineJoint<6>({.dt = 0.008}) + GravityControl{}, guard));
}
