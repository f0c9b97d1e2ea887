// expect: v = tau.*v = as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
#ifdef SKINCTL_RIGHT
  const Vec6<double> v = as_eigen(tau);
#else
  const Vec6<double> v = tau;
#endif
  static_cast<void>(v);
}
