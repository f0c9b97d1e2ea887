// expect: \(tau \* dq\).*for tau \. dq: power\(tau, dq\)
#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const JointVelocity<6> dq;
  static_cast<void>(tau * dq);
}
