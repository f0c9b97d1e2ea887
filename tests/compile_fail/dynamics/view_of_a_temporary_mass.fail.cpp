// expect: as_eigen\(mass_matrix.*give it a name
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  static_cast<void>(as_eigen(mass_matrix(model, JointPosition<6>{})));
}
