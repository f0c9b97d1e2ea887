#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointVelocity<6> dq;
  const auto Y = regressor(ur5::Model{}, JointPosition<6>{}, dq, dq, JointAcceleration<6>{});
  [[maybe_unused]] const InertialParameters<6> theta;
  [[maybe_unused]] const InertialParameters<7> of_another;
  static_cast<void>(Y * theta);
}
