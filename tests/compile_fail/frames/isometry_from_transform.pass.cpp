#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<World, Tool> X_WT;
  const Eigen::Isometry3d X = as_eigen(X_WT);
  static_cast<void>(X);
}
