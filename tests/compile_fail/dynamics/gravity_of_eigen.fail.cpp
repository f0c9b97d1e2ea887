// expect: gravity_torque\(model, v\).*JointPosition<N>\(v\)
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  const Vec6<double> v = Vec6<double>::Zero();
#ifdef SKINCTL_RIGHT
  static_cast<void>(gravity_torque(model, JointPosition<6>(v)));
#else
  static_cast<void>(gravity_torque(model, v));
#endif
}
