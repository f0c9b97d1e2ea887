// expect: \(q \+ tau\).*other kind, size or scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointTorque<6> tau;
#ifdef SKINCTL_RIGHT
  static_cast<void>(tau + tau);
#else
  static_cast<void>(q + tau);
#endif
}
