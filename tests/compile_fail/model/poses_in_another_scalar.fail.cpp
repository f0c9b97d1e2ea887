// expect: the model computes in another scalar
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(link_poses(calibrated_from<ur5::Description>(), JointPosition<6, float>{}));
}
