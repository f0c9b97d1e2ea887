// SPDX-License-Identifier: BSD-3-Clause
// What the uncertainty of cells' poses does to the torque of the skin, and which cells it makes useless.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/calibration/sighting_types.hpp"
#include "skinctl/calibration/turn.hpp"
#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A cell on its link with the covariance of the error of its pose: place in the axes of its patch [m], then
/// turn in its own [rad].
struct UncertainCell {
  FitPose X_RootCell;
  Matrix6d covariance = Matrix6d::Zero();
};
/// A patch on its link; the covariance is of the place of its root in the link's axes [m], then of its turn
/// in its own [rad].
struct UncertainPatch {
  FitPose X_LinkRoot;
  Matrix6d covariance = Matrix6d::Zero();
  std::vector<UncertainCell> cells;

  [[nodiscard]] FitPose X_LinkCell(std::size_t i) const { return X_LinkRoot * cells[i].X_RootCell; }
};

/// The wrench `u = -[z; p x z]` on the link, at its origin and in its axes, by one newton on the cell.
[[nodiscard]] inline Vector6d unit_wrench(const FitPose& X_LinkCell) {
  const Eigen::Vector3d z = X_LinkCell.R.col(2);
  Vector6d u;
  u << -z, -X_LinkCell.p.cross(z);
  return u;
}

/// The derivative `B` of `unit_wrench` by an error `e` of the cell's pose, `du = B e`: place in the link's
/// axes [m], then turn in the cell's own [rad].
[[nodiscard]] inline Matrix6d wrench_by_pose(const FitPose& X_LinkCell) {
  const Eigen::Vector3d z = X_LinkCell.R.col(2);
  const Eigen::Matrix3d turned = X_LinkCell.R * cross_matrix(Eigen::Vector3d::UnitZ());
  Matrix6d B;
  B << Eigen::Matrix3d::Zero(), turned, cross_matrix(z), cross_matrix(X_LinkCell.p) * turned;
  return B;
}

namespace detail {
/// The derivative of `unit_wrench` by the cell's own error, its place in the patch's axes.
[[nodiscard]] inline Matrix6d wrench_by_own(const UncertainPatch& patch, std::size_t i) {
  Matrix6d B = wrench_by_pose(patch.X_LinkCell(i));
  B.leftCols<3>() = B.leftCols<3>() * patch.X_LinkRoot.R;
  return B;
}
/// The derivative of `unit_wrench` by the patch's error, which moves all of its cells.
[[nodiscard]] inline Matrix6d wrench_by_patch(const UncertainPatch& patch, std::size_t i) {
  const FitPose X = patch.X_LinkCell(i);
  Matrix6d moved = Matrix6d::Zero();
  moved.topLeftCorner<3, 3>().setIdentity();
  moved.topRightCorner<3, 3>() = -cross_matrix(X.p - patch.X_LinkRoot.p) * patch.X_LinkRoot.R;
  moved.bottomRightCorner<3, 3>() = X.R.transpose() * patch.X_LinkRoot.R;
  return wrench_by_pose(X) * moved;
}
}  // namespace detail

/// Covariance of a patch's joint torque `T sum s_i u_i`: its cells' own errors by their squares, the patch's
/// common one linearly.
///
/// @param T         transposed Jacobian of the link: torques of a wrench `[f; m]` at its origin, in its axes.
/// @param readings  s_i, forces on the cells [N].
[[nodiscard]] inline Eigen::MatrixXd torque_covariance(const Eigen::MatrixXd& T, const UncertainPatch& patch,
                                                       const std::vector<double>& readings) {
  require(readings.size() == patch.cells.size(), "torque covariance: readings", double(readings.size()),
          "one per cell");
  require(T.cols() == 6, "torque covariance: columns of the Jacobian's transpose", double(T.cols()), "6");
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(T.rows(), T.rows()),
                  common = Eigen::MatrixXd::Zero(T.rows(), 6);
  const auto add = [&](const Eigen::MatrixXd& by, const Eigen::MatrixXd& covariance) {
    const Eigen::MatrixXd spread = by * covariance;
    out.noalias() += spread * by.transpose();
  };
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i] == 0) continue;
    Eigen::MatrixXd own = detail::wrench_by_own(patch, i), moved = detail::wrench_by_patch(patch, i);
    own *= readings[i], moved *= readings[i];
    common.noalias() += T * moved;
    add(T * own, patch.cells[i].covariance);
  }
  add(common, patch.covariance);
  return out;
}

/// Standard deviation of a cell's joint torque relative to the torque itself, root mean square over
/// configurations (each a `T` of `torque_covariance`); infinite for a cell that causes none, or of which
/// nothing is known.
[[nodiscard]] inline double relative_deviation(const std::vector<Eigen::MatrixXd>& configurations,
                                               const UncertainPatch& patch, std::size_t cell) {
  double off = 0, all = 0;
  std::vector<double> one(patch.cells.size(), 0.0);
  one[cell] = 1;
  for (const auto& T : configurations) {
    off += torque_covariance(T, patch, one).trace();
    all += (T * unit_wrench(patch.X_LinkCell(cell))).squaredNorm();
  }
  return off >= 0 && all > 0 ? std::sqrt(off / all) : std::numeric_limits<double>::infinity();
}

/// The reason for which a cell of a patch is masked, as the skin file says it; empty: it counts. Cells are
/// masked like dead ones where their torque is off by more than the share `limit` of it, rms. They are not
/// weighted: weights by their uncertainty lower the error of the sum by 0.4 % at 5 deg and 5 % at 15 deg, and
/// make a touch feel lighter than it is.
[[nodiscard]] inline std::string mask_reason(const std::vector<Eigen::MatrixXd>& configurations,
                                             const UncertainPatch& patch, std::size_t cell,
                                             double limit = 0.3) {
  require(limit > 0 && limit <= 10, "mask: limit", limit, "0 to 10");
  const double off = relative_deviation(configurations, patch, cell);
  if (off <= limit) return {};
  if (!(off < 100)) return "pose unknown";
  char text[80];
  std::snprintf(text, sizeof text, "pose too uncertain: torque off by %.0f %%, limit %.0f %%", 100 * off,
                100 * limit);
  return text;
}

SKINCTL_END_NAMESPACE
