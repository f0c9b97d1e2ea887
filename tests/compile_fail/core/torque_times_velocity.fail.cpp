// expect: \(tau \* dq\).*for tau \. dq: power\(tau, dq\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const JointVelocity<6> dq;
#ifdef SKINCTL_RIGHT
  static_cast<void>(power(tau, dq));
#else
  static_cast<void>(tau * dq);
#endif
}
