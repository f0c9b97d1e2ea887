// expect: \(tau \* dq\).*for tau \. dq: power\(tau, dq\)
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const JointVelocity<6> dq;
  static_cast<void>(tau * dq);
}
