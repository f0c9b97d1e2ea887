// expect: other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Arm = JointGroup<Interface::velocity, joints_between(0, 6)>;
using Hand = JointGroup<Interface::torque, joints_between(6, 22)>;
using Robot = Resolver<ur5_allegro::Model<>, double, JointGroups<22, Arm, Hand>>;

#ifdef SKINCTL_RIGHT
JointVelocity<6> arm(const Robot::Sent& command) {
  return Robot::stiff(command).velocity;
}
#else
JointTorque<6> arm(const Robot::Sent& command) {
  return Robot::torque(command);
}
#endif
