#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Vector3d f = Eigen::Vector3d::Zero();
  const Wrench<Tool> G{as_xyz(f), {}};
  static_cast<void>(G);
}
