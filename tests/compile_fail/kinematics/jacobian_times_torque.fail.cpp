// expect: a Jacobian takes joint velocities or accelerations
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto J = jacobian<3>(link_poses(ur5::Model{}, JointPosition<6>{}));
  [[maybe_unused]] const JointTorque<6> tau;
  [[maybe_unused]] const JointVelocity<6> dq;
#ifdef SKINCTL_RIGHT
  static_cast<void>(J * dq);
#else
  static_cast<void>(J * tau);
#endif
}
