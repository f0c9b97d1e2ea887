// expect: v = tau.*v = as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  Eigen::VectorXd v;
#ifdef SKINCTL_RIGHT
  v = as_eigen(tau);
#else
  v = tau;
#endif
}
