// expect: as_eigen\(mass_matrix.*give it a name
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
#ifdef SKINCTL_RIGHT
  const auto M = mass_matrix(model, JointPosition<6>{});
  static_cast<void>(as_eigen(M));
#else
  static_cast<void>(as_eigen(mass_matrix(model, JointPosition<6>{})));
#endif
}
