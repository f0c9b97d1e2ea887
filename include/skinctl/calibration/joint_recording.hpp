// SPDX-License-Identifier: BSD-3-Clause
// A recording of joints by their encoders, and a point of a motion: what moves a robot needs no fit of them
// (joint_motion.hpp).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Positions of joints as their encoders reported them.
struct JointRecording {
  std::vector<double> time;  ///< stamps [s], increasing
  Eigen::MatrixXd q;         ///< a row per stamp, a column per joint [rad]
};

/// Position, velocity and acceleration of all joints [rad, rad/s, rad/s^2].
struct JointPoint {
  Eigen::VectorXd q, dq, ddq;
};

SKINCTL_END_NAMESPACE
