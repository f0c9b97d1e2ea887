// expect: G.*Vector3d|Vector3d.*G
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Eigen::Vector3d f = Eigen::Vector3d::Zero();
#ifdef SKINCTL_RIGHT
  const Wrench<Tool> G{as_xyz(f), {}};
#else
  const Wrench<Tool> G{f, {}};
#endif
  static_cast<void>(G);
}
