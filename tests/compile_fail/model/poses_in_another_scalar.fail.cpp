// expect: the model computes in another scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
#ifdef SKINCTL_RIGHT
  static_cast<void>(link_poses(calibrated_from<ur5::Description>(), JointPosition<6, double>{}));
#else
  static_cast<void>(link_poses(calibrated_from<ur5::Description>(), JointPosition<6, float>{}));
#endif
}
