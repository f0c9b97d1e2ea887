#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Wrench<Tool> G;
  G.force = as_xyz(f);
}
