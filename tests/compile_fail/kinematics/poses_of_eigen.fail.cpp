// expect: link_poses\(model, v\).*JointPosition<N>\(v\)
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  const Vec6<double> v = Vec6<double>::Zero();
#ifdef SKINCTL_RIGHT
  static_cast<void>(link_poses(model, JointPosition<6>(v)));
#else
  static_cast<void>(link_poses(model, v));
#endif
}
