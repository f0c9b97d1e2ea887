#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(JointLimitLaw<6>{} + SplineJoint<6>{{.dt = 2ms}} + GravityControl{});
}
