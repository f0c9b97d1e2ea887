// expect: body, point and axes of J and F differ
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto J = jacobian<3>(link_poses(ur5::Model{}, JointPosition<6>{}));
  [[maybe_unused]] const Wrench<Link<2>, Link<2>, Base> F_2;
  [[maybe_unused]] const Wrench<Link<3>, Link<3>, Base> F_3;
#ifdef SKINCTL_RIGHT
  static_cast<void>(transpose(J) * F_3);
#else
  static_cast<void>(transpose(J) * F_2);
#endif
}
