#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Transform<World, Tool> X_WT;
  X_WT = Transform<World, Tool>(X);
}
