// expect: a law adds to laws only
#include <Eigen/Core>

#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::SkinJointControl skin;
  const Eigen::VectorXd tau = Eigen::VectorXd::Zero(6);
  static_cast<void>(skin + tau);
}
