#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const Vec6<double> v = as_eigen(tau);
  static_cast<void>(v);
}
