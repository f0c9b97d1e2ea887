// What a UR5 may do while it moves for a calibration, and the pose that it starts from.
#pragma once

#include "skinctl/calibration/excitation.hpp"

namespace skinctl::testing {

inline const Eigen::VectorXd ur5_home = (Eigen::VectorXd(6) << 0.2, -1.3, 1.2, -1.2, -1.4, 0.3).finished();

inline ExcitationLimits ur5_limits() {
  ExcitationLimits l;
  l.lower = Eigen::VectorXd::Constant(6, -6.28), l.upper = Eigen::VectorXd::Constant(6, 6.28);
  l.lower(2) = -3.14, l.upper(2) = 3.14;
  l.velocity = Eigen::VectorXd::Constant(6, 3.14), l.acceleration = Eigen::VectorXd::Constant(6, 25);
  l.torque = (Eigen::VectorXd(6) << 150, 150, 150, 28, 28, 28).finished();
  return l;
}

}  // namespace skinctl::testing
