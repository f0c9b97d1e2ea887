// expect: no matching function for call to .power.*power\(tau, q\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  [[maybe_unused]] const JointPosition<6> q;
  [[maybe_unused]] const JointVelocity<6> dq;
#ifdef SKINCTL_RIGHT
  static_cast<void>(power(tau, dq));
#else
  static_cast<void>(power(tau, q));
#endif
}
