// expect: G.force = f.*as_xyz
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Wrench<Tool> G;
#ifdef SKINCTL_RIGHT
  G.force = as_xyz(f);
#else
  G.force = f;
#endif
}
