// expect: q = tau.*other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
#ifdef SKINCTL_RIGHT
  const JointTorque<6> q = tau;
#else
  const JointPosition<6> q = tau;
#endif
  static_cast<void>(q);
}
