#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  Eigen::VectorXd v;
  v = as_eigen(tau);
}
