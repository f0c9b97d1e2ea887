#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(gravity_torque(calibrated_from<ur5::Description>(), JointPosition<6, double>{}));
}
