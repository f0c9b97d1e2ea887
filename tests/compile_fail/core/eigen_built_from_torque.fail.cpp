// expect: v = tau.*v = as_eigen
#include <Eigen/Geometry>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointTorque<6> tau;
  const Vec6<double> v = tau;
  static_cast<void>(v);
}
