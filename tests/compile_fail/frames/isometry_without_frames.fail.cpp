// expect: X_WT = X.*Transform<A, B>\(isometry\)
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Transform<World, Tool> X_WT;
#ifdef SKINCTL_RIGHT
  X_WT = Transform<World, Tool>(X);
#else
  X_WT = X;
#endif
}
