// expect: task_priority: a gate opens in time, in blended\(sum\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const SplineJoint<6> reach;
  static_cast<void>(task_priority<5>(reach, when_untouched(JointLimitLaw<6>())));
}
