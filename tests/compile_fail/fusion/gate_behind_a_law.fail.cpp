// expect: task_priority: a gate opens in time, in blended\(sum\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const SplineJoint<6> reach;
#ifdef SKINCTL_RIGHT
  static_cast<void>(task_priority<5>(reach, JointLimitLaw<6>()));
#else
  static_cast<void>(task_priority<5>(reach, when_untouched(JointLimitLaw<6>())));
#endif
}
