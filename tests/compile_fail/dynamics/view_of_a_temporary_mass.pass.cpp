#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const ur5::Model model;
  const auto M = mass_matrix(model, JointPosition<6>{});
  static_cast<void>(as_eigen(M));
}
