// expect: its transpose a wrench
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto J = jacobian<3>(link_poses(ur5::Model{}, JointPosition<6>{}));
  const Wrench<Link<3>, Link<3>, Base> F;
#ifdef SKINCTL_RIGHT
  static_cast<void>(transpose(J) * F);
#else
  static_cast<void>(J * F);
#endif
}
