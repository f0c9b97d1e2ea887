// expect: the laws of a sum are for robots with different numbers of joints
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(JointLimitLaw<6>{} + SplineJoint<6>{{.dt = 2ms}} + GravityControl{});
#else
  static_cast<void>(JointLimitLaw<6>{} + SplineJoint<7>{{.dt = 2ms}} + GravityControl{});
#endif
}
