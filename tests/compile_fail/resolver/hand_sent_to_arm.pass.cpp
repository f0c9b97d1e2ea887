#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = HybridResolver<Interface::velocity, joints_between(6, 22), ur5_allegro::Model<>>;

JointVelocity<6> arm(const JointCommand<22>& command) {
  return Robot::stiff(command).velocity;
}
