// expect: v = tau.*v = as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  Eigen::VectorXd v;
  v = tau;
}
