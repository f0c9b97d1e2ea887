#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Hand = Skin<ur5::Model, double, Patch<5, 1>>;

using Robot = Resolver<Interface::position, ur5::Model>;

void build(const Robot& robot, const Guard<Interface::position, 6>& guard, const Hand& skin) {
  static_cast<void>(Cycle(robot, SkinJointControl{} + GravityControl{}, skin, guard));
}
