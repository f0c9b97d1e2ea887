// SPDX-License-Identifier: BSD-3-Clause
// Which joint moves which cell of a skin, and the joints' axes as a cell sees them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "skinctl/calibration/detail/block_means.hpp"
#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/joint_motion.hpp"
#include "skinctl/calibration/turn.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The reading of a cell while one joint moves alone, in the axes of its sensor and in g:
/// ```
/// y = (n x r) ddq/|g| - r_perp dq^2/|g| + e_par + b + e_perp cos q - (n x e_perp) sin q
/// ```
/// with `n` the unit vector of the joint's axis, `r` from a point of the axis to the cell, `e` upwards, `b`
/// the bias, and q from home.
struct JointSignature {
  bool measured = false;  ///< the joint moved alone for 1 s or more, and the cell reported
  double F = 0;           ///< explained variance per unexplained one; about 1 for a cell that does not move
  double radius = 0;      ///< distance of the cell from the axis, |n x r| [m]
  double turn = 0;        ///< part of gravity across the axis, which turns in the cell: |e_perp| [g]
  double certainty = 0;   ///< certainty of the axis: signal over noise
  bool moves = false;     ///< the joint moves the cell
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    ///< n, unit vector of the axis, along the cell's axes
  Eigen::Vector3d to_axis = Eigen::Vector3d::Zero();  ///< way from the cell to the axis' nearest point [m]
  Eigen::Vector3d up = Eigen::Vector3d::Zero();       ///< reading at rest at home: upwards, plus bias [g]
};

struct ActivationSettings {
  double F = 8;              ///< variance ratio that a moved cell exceeds
  double radius = 0.005;     ///< least distance from the axis of a moved cell [m], unless `turn` shows it
  double turn = 0.005;       ///< least gravity across the axis at a moved cell [g], unless `radius` shows it
  double still = 0.003;      ///< largest distance from home of a joint that stands still [rad]
  double gravity = 9.80665;  ///< gravity [m/s^2]
};

/// The joints that move each cell.
struct Activation {
  Eigen::VectorXd home;           ///< position of the joints at the first stamp of the recording [rad]
  std::vector<bool> moved_alone;  ///< joints that moved alone, from home, for a second or more
  double lateness = 0;            ///< lateness of the cells' time stamps, to 10 ms [s]
  std::vector<std::vector<JointSignature>> cells;  ///< signatures by cell, then by joint
  /// Index of the last joint that moves a cell, whose link carries it; -1: none does.
  [[nodiscard]] int link(std::size_t cell) const noexcept {
    int last = -1;
    for (std::size_t j = 0; j < cells[cell].size(); ++j)
      if (cells[cell][j].moves) last = int(j);
    return last;
  }
};

namespace detail::fit {

inline constexpr double gauss_place[3] = {-0.3872983346207417, 0,
                                          0.3872983346207417};  // in lengths of an interval
inline constexpr double gauss_weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

/// The blocks in which one joint moves and all others stand at home, and the regressor in them.
struct AloneBlocks {
  std::vector<Eigen::Index> blocks;
  Eigen::Matrix<double, -1, 5> rows;
};
inline AloneBlocks alone_blocks(const BlockMeans& data, const MeasuredMotion& motion,
                                const Eigen::VectorXd& home, int joint, double lateness,
                                const ActivationSettings& s) {
  AloneBlocks out;
  std::vector<Eigen::Matrix<double, 5, 1>> rows;
  JointPoint p;
  for (Eigen::Index k = 0; k < data.blocks(); ++k) {
    Eigen::Matrix<double, 5, 1> row = Eigen::Matrix<double, 5, 1>::Zero();
    bool alone = true, moves = false;
    const double middle = data.middle(k) - lateness;
    if (motion.gap_within(middle - data.length, middle + data.length)) continue;
    for (int g = 0; g < 3 && alone; ++g) {
      motion.at(middle + gauss_place[g] * data.length, p);
      for (int i = 0; i < motion.joints(); ++i)
        if (i != joint) alone = alone && std::abs(p.q(i) - home(i)) < s.still && std::abs(p.dq(i)) < 0.02;
      const double q = p.q(joint) - home(joint), dq = p.dq(joint);
      moves = moves || std::abs(q) > 0.01 || std::abs(dq) > 0.02;
      Eigen::Matrix<double, 5, 1> x;
      x << p.ddq(joint) / s.gravity, dq * dq / s.gravity, 1, std::cos(q), std::sin(q);
      row += gauss_weight[g] * x;
    }
    if (alone && moves) out.blocks.push_back(k), rows.push_back(row);
  }
  out.rows.resize(Eigen::Index(rows.size()), 5);
  for (std::size_t k = 0; k < rows.size(); ++k) out.rows.row(Eigen::Index(k)) = rows[k].transpose();
  return out;
}

/// Sets `out` by the regression of one cell in the blocks of one joint. Returns the sum of squared residuals
/// [g^2]; 0 if there are too few blocks.
inline double signature(const BlockMeans& data, const AloneBlocks& alone, Eigen::Index cell,
                        const ActivationSettings& s, JointSignature& out) {
  std::vector<Eigen::Index> rows;
  for (std::size_t k = 0; k < alone.blocks.size(); ++k)
    if (!data.missing(alone.blocks[k], cell)) rows.push_back(Eigen::Index(k));
  out = {};
  if (double(rows.size()) * data.length < 0.8 || rows.size() < 15) return 0;
  const auto n = Eigen::Index(rows.size());
  Eigen::MatrixXd X(n, 5), Y(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    X.row(k) = alone.rows.row(rows[std::size_t(k)]);
    for (int a = 0; a < 3; ++a)
      Y(k, a) = data.y(alone.blocks[std::size_t(rows[std::size_t(k)])], 3 * cell + a);
  }
  // Of columns in units of their size.
  Eigen::MatrixXd normal_matrix = X.transpose() * X;
  double size[5];
  for (int k = 0; k < 5; ++k) size[k] = std::sqrt(normal_matrix(k, k));
  if (!(*std::min_element(size, size + 5) > 1e-9)) return 0;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) normal_matrix(i, k) /= size[i] * size[k];
  const Cholesky factor(normal_matrix);
  for (int k = 0; k < 5; ++k)
    if (!factor.positive() || !(factor.factor(k, k) > 3e-5)) return 0;
  Eigen::MatrixXd inverse = factor.inverse();
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k) inverse(i, k) /= size[i] * size[k];
  const Eigen::MatrixXd B = inverse * (X.transpose() * Y);  // 5 x 3
  const double rest = (Y - X * B).squaredNorm();
  double plain = Y.squaredNorm();
  for (int k = 0; k < 3; ++k) plain -= double(n) * std::pow(Y.col(k).mean(), 2);
  const double variance = std::max(rest / double(3 * (n - 5)), 1e-12);
  out.measured = true;
  out.F = std::max(0.0, plain - rest) / 12 / variance;
  const Eigen::Vector3d u1 = B.row(0), u2 = B.row(1), cosine = B.row(3), sine = B.row(4);
  out.radius = u1.norm(), out.turn = sine.norm();
  out.moves = out.F > s.F && (out.radius > s.radius || out.turn > s.turn);
  out.up = B.row(2) + B.row(3);
  // All four vectors are normal to the axis.
  double weight[5];
  for (int k = 0; k < 5; ++k) weight[k] = 1 / std::sqrt(variance * std::max(inverse(k, k), 1e-15));
  Eigen::MatrixXd normal = B;
  for (int k = 0; k < 5; ++k) normal.row(k) *= k == 2 ? 0 : weight[k];
  const SymmetricEigen spread(normal.transpose() * normal);
  out.axis = spread.vectors.col(0);
  out.certainty = std::sqrt(std::max(0.0, spread.values(1)));
  const Eigen::Vector3d side =
      weight[0] * weight[1] * u1.cross(u2) + weight[3] * weight[4] * sine.cross(cosine);
  if (side.dot(out.axis) < 0) out.axis = -out.axis;
  const double a = weight[0] * weight[0], b = weight[1] * weight[1];
  out.to_axis = (b * u2 - a * u1.cross(out.axis)) / (a + b);
  out.to_axis -= out.axis * out.axis.dot(out.to_axis);
  return rest;
}

}  // namespace detail::fit

/// Finds which joints move which cells, from blocks in which single joints move while the others stand at
/// home, their positions at the start of the recording.
[[nodiscard]] inline Activation find_activation(const detail::fit::BlockMeans& data,
                                                const MeasuredMotion& motion,
                                                const ActivationSettings& settings = {}) {
  Activation out;
  const int joints = motion.joints();
  out.home = motion.first();
  // How late the labels are: what explains a few cells best.
  const auto cells = data.cells();
  const Eigen::Index stride = std::max<Eigen::Index>(1, cells / 24);
  double best = 1e300;
  for (int late = -4; late <= 16; ++late) {
    double squares = 0;
    for (int j = 0; j < joints; ++j) {
      const auto alone = detail::fit::alone_blocks(data, motion, out.home, j, 0.01 * late, settings);
      JointSignature s;
      for (Eigen::Index c = 0; c < cells; c += stride) {
        const double rest = detail::fit::signature(data, alone, c, settings, s);
        if (s.measured) squares += rest / double(alone.blocks.size());
      }
    }
    if (squares < best) best = squares, out.lateness = 0.01 * late;
  }
  out.cells.assign(std::size_t(cells), std::vector<JointSignature>(std::size_t(joints)));
  for (int j = 0; j < joints; ++j) {
    const auto alone = detail::fit::alone_blocks(data, motion, out.home, j, out.lateness, settings);
    out.moved_alone.push_back(double(alone.blocks.size()) * data.length >= 1);
    for (Eigen::Index c = 0; c < cells; ++c)
      detail::fit::signature(data, alone, c, settings, out.cells[std::size_t(c)][std::size_t(j)]);
  }
  return out;
}

SKINCTL_END_NAMESPACE
