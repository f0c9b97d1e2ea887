// expect: as_eigen\(tau\(\)\).*give it a name
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const auto tau = [] { return JointTorque<6>{}; };
#ifdef SKINCTL_RIGHT
  const auto named = tau();
  static_cast<void>(as_eigen(named));
#else
  static_cast<void>(as_eigen(tau()));
#endif
}
