// expect: this law is for a robot in another scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model>;

void build(const Robot& robot, const Guard<Interface::position, 6>& guard) {
  static_cast<void>(Cycle(robot, SplineJoint<6, float>({.dt = 0.008F}) + GravityControl{}, guard));
}
