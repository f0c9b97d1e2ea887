#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const SplineJoint<6> reach;
  static_cast<void>(task_priority<5>(reach, JointLimitLaw<6>()));
}
