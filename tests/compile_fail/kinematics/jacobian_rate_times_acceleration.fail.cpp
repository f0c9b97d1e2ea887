// expect: the rate of a Jacobian takes joint velocities
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  [[maybe_unused]] const JointVelocity<6> dq;
  [[maybe_unused]] const JointAcceleration<6> ddq;
  const auto J = jacobian<5>(link_poses(ur5::Model{}, JointPosition<6>{}));
  const auto dJ = jacobian_rate(J, dq);
#ifdef SKINCTL_RIGHT
  static_cast<void>(dJ * dq);
#else
  static_cast<void>(dJ * ddq);
#endif
}
