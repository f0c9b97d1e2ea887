// expect: no member named .*torque
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm =
    Resolver<ur5::Model, double, JointGroups<6, JointGroup<Interface::position, joints_between(0, 6)>>>;
using Scene = Cycle<Arm, GravityControl>;

auto sent(const Scene::Output& out) {
#ifdef SKINCTL_RIGHT
  return out.command.position;
#else
  return out.command.torque;
#endif
}
