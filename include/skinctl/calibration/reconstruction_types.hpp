// SPDX-License-Identifier: BSD-3-Clause
// What a reconstruction of a patch takes and gives.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "skinctl/calibration/accelerometer.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/estimate.hpp"
#include "skinctl/calibration/fit_end.hpp"
#include "skinctl/skin_network/patch_graph.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Places of a cell's ports, in its frame [m]; ports 0 to 3.
using CellPorts = std::array<Eigen::Vector3d, 4>;
/// The ports of TUM's cell, with all distances times `scale`.
[[nodiscard]] inline CellPorts hexagonal_ports(double scale = 1) {
  const double x = 0.012 * scale, y = 0.007 * scale;
  return {Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x, -y, 0), Eigen::Vector3d(-x, y, 0),
          Eigen::Vector3d(-x, -y, 0)};
}

/// A cell of a patch: its pose in the patch's frame, which is that of its root cell.
struct ReconstructedCell {
  std::uint16_t id = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< axes of the cell in the patch: R_RootCell
  Eigen::Vector3d p = Eigen::Vector3d::Zero();      ///< origin of the cell in the patch [m]
  AccelerometerErrors errors{};
  /// Covariance of the errors of position [m], in the patch's axes, and rotation vector [rad], in the cell's
  /// own, after the patch as a whole has been aligned: how the patch sits on its link is another question.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::string unknown{};  ///< reason for which the pose is not known; empty: it is

  /// Standard deviation of the position in its worst direction [m].
  [[nodiscard]] double place_deviation() const { return worst(covariance.topLeftCorner<3, 3>()); }
  /// Standard deviation of the turn about its worst axis [rad].
  [[nodiscard]] double turn_deviation() const { return worst(covariance.bottomRightCorner<3, 3>()); }

 private:
  [[nodiscard]] static double worst(const Eigen::Matrix3d& C) {
    if (!C.allFinite()) return std::numeric_limits<double>::infinity();
    return std::sqrt(std::max(0.0, detail::SymmetricEigen(C).largest()));
  }
};

struct ReconstructionSettings {
  CellPorts ports = hexagonal_ports();
  AccelerometerPrior prior{};
  double reading = 2.5e-3;  ///< standard deviation of a mean reading, with what the equation leaves out [g]
  /// Standard deviation of the gap between two joined ports [m]; 3e-4 for connectors that stretch.
  double gap = 1e-4;
  double turn_limit = 3 * 0.0174532925;  ///< standard deviation above which a cell's turn is reported [rad]
  double place_limit = 3e-3;             ///< standard deviation above which a cell's place is reported [m]
};

/// The result of `reconstruct`. Of a patch in several pieces, by the readings, the largest is known.
struct Reconstruction {
  std::vector<ReconstructedCell> cells;    ///< cells in the order of `PatchGraph::ids`
  std::vector<Eigen::Vector3d> up;         ///< unit vector upwards in the patch's frame, one per pose
  std::vector<Unobservable> unobservable;  ///< cells whose pose is not known, and why
  FitEnd end = FitEnd::not_finite;
  int steps = 0;
  double residual = 0;  ///< rms residual of the readings [g]
};

/// Mean readings at rest of the cells of a patch [g]: `[cell][pose]`, in the order of `PatchGraph::ids`. A
/// pose that a cell has no reading of is NaN.
using RestReadings = std::vector<std::vector<Eigen::Vector3d>>;

SKINCTL_END_NAMESPACE
