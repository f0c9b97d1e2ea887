// expect: a law adds to laws only
#ifndef SKINCTL_RIGHT
#include <Eigen/Core>
#endif
#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::SkinJointControl skin;
#ifdef SKINCTL_RIGHT
  const skinctl::GravityControl gravity;
  static_cast<void>(skin + gravity);
#else
  const Eigen::VectorXd tau = Eigen::VectorXd::Zero(6);
  static_cast<void>(skin + tau);
#endif
}
