// SPDX-License-Identifier: BSD-3-Clause
// What `find_joint_lines` takes and gives: a recording of a motion, lines of joints, poses of cells.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/calibration/activation.hpp"
#include "skinctl/calibration/detail/line_motion.hpp"
#include "skinctl/calibration/estimate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Knowledge of a cell before the motion: its pose in a reconstructed patch.
struct CellInPatch {
  int patch = -1;                                   ///< index of the patch; -1: the cell is of none
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< axes of the cell in the patch
  Eigen::Vector3d p = Eigen::Vector3d::Zero();      ///< origin of the cell in the patch [m]
};

/// A motion, and what encoders and cells reported of it; one clock, but for a lateness that all cells share.
struct MotionRecording {
  JointRecording joints;
  std::vector<CellReadings> cells;
  std::vector<CellInPatch> places{};  ///< poses in patches, one per cell; empty: cells are on their own
  /// Torques at the joints' outputs, a row per stamp of `joints`, or none [N m]: a robot's own prediction
  /// (`target_moment`) will do. With them the joints' compliance is fitted; a joint that gives way by 5e-5
  /// rad/(N m) costs 6 mm otherwise.
  Eigen::MatrixXd torque{};
};

struct JointLinesSettings {
  double block = 0.04;       ///< length of the blocks whose means are fitted [s], 0.005 to 0.1
  double gravity = 9.80665;  ///< gravity [m/s^2]
  double bias = 0.040;       ///< standard deviation of an accelerometer's bias [g]
  double scale = 0.015;      ///< standard deviation of an accelerometer's scale factor, whose mean is 1
  double cross_axis =
      0.003;  ///< standard deviation of the cross-axis sensitivity, of which the symmetric part is fitted
  double tie_position = 5e-4;     ///< standard deviation of a cell's position in its patch [m]
  double tie_turn = 0.0175;       ///< standard deviation of a cell's turn in its patch, sensor included [rad]
  double known_position = 0.020;  ///< standard deviation above which a position is not observed [m]
  double known_turn = 0.0873;     ///< standard deviation above which a turn is not observed [rad]
  int steps = 30;
  ActivationSettings activation{};
};

/// The calibrated pose of a cell with the joints at home, in the axes of the base.
struct CalibratedCell {
  int joint = -1;  ///< last joint that moves the cell; -1: none does, and the rest is not known
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< origin of the cell [m]
  /// Covariance of the errors of p [m], then of the turn in the cell's axes [rad].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< bias of the cell's accelerometer [g]
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
  double residual = 0;   ///< standard deviation of the cell's block means from the fit [g]
  bool known = false;    ///< pose within the limits of the settings
  std::string reason{};  ///< reason for which the pose is not known; empty: it is
};

/// A joint's axis at home, in the axes of the base.
struct CalibratedLine {
  AxisLine line;
  double direction_deviation = std::numeric_limits<double>::infinity();  ///< largest standard deviation [rad]
  double position_deviation = std::numeric_limits<double>::infinity();   ///< largest across the line [m]
  bool known = false;
  Estimate compliance;  ///< compliance of the joint [rad/(N m)]; known if torques were recorded
};

/// The result of `find_joint_lines`. The base is upright; its position and heading are a choice (gauge) that
/// no covariance contains: they are those of poses relative to the cells that are known, taken together.
struct JointLines {
  Eigen::VectorXd home;  ///< joints' positions to which lines and poses belong [rad]
  std::vector<CalibratedLine> lines;
  std::vector<CalibratedCell> cells;
  Estimate lateness;    ///< lateness of the cells' time stamps [s]
  double residual = 0;  ///< rms residual of all blocks [g]
  int steps = 0;
  bool converged = false;
  std::vector<Unobservable> unobservable;
  std::vector<int> joints;  ///< fitted joints; all others moved no cell, or did not move
  Activation activation;
};

SKINCTL_END_NAMESPACE
