#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto tau = [] { return JointTorque<6>{}; };
  const auto named = tau();
  static_cast<void>(as_eigen(named));
}
