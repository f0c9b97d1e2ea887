#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const JointVelocity<6> dq;
  static_cast<void>(power(tau, dq));
}
