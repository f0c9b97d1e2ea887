// expect: Y takes inertial parameters of the same robot
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointVelocity<6> dq;
  const auto Y = regressor(ur5::Model{}, JointPosition<6>{}, dq, dq, JointAcceleration<6>{});
  [[maybe_unused]] const InertialParameters<6> theta;
  [[maybe_unused]] const InertialParameters<7> of_another;
#ifdef SKINCTL_RIGHT
  static_cast<void>(Y * theta);
#else
  static_cast<void>(Y * of_another);
#endif
}
