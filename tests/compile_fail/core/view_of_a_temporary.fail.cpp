// expect: as_eigen\(tau\(\)\).*give it a name
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto tau = [] { return JointTorque<6>{}; };
  static_cast<void>(as_eigen(tau()));
}
