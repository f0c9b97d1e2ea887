// expect: other kind, size or scalar|does not match adjusted type
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(
      inverse_dynamics(ur5::Model{}, JointPosition<6>{}, JointVelocity<6>{}, JointAcceleration<6>{}));
#else
  static_cast<void>(
      inverse_dynamics(ur5::Model{}, JointPosition<7>{}, JointVelocity<7>{}, JointAcceleration<7>{}));
#endif
}
