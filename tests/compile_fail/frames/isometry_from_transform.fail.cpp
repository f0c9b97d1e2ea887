// expect: X = X_WT.*as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<World, Tool> X_WT;
#ifdef SKINCTL_RIGHT
  const Eigen::Isometry3d X = as_eigen(X_WT);
#else
  const Eigen::Isometry3d X = X_WT;
#endif
  static_cast<void>(X);
}
