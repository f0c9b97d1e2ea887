// SPDX-License-Identifier: BSD-3-Clause
// Cells on moved bodies: unknowns, signals, and equations from which the cells are eliminated.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/calibration/detail/block_means.hpp"
#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/nearest_turn.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/turn.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// The specific force on a body that sits at `p` is `A + S p` [g], in the body's axes. A row per block: A, S
/// row by row, 1, and then the derivatives of A and S by each unknown of the motion, twelve columns an
/// unknown.
struct BodySignals {
  static constexpr Eigen::Index own = 13, each = 12;
  std::vector<int> unknowns;  ///< indices of the unknowns on which the body's motion depends
  Eigen::MatrixXd columns;
};

/// Number of unknowns of a cell: turn, place, bias, scale, cross-axis sensitivity, three each.
inline constexpr int cell_unknowns = 15;
using CellVector = Eigen::Matrix<double, cell_unknowns, 1>;

/// A cell: its pose in the body's axes and origin, its sensor's errors, what it is tied to. It reads, of the
/// specific force u in the sensor's axes, `y = (1 + s) o (u + X u) + b`.
struct FittedCell {
  Eigen::Matrix3d Q = Eigen::Matrix3d::Identity();  ///< axes of the sensor
  Eigen::Vector3d p = Eigen::Vector3d::Zero();      ///< origin of the cell [m]
  Eigen::Vector3d b = Eigen::Vector3d::Zero();      ///< bias [g]
  Eigen::Vector3d s = Eigen::Vector3d::Zero();      ///< relative error of the scale [1]
  /// Cross-axis sensitivity, the symmetric X: between y and z, z and x, x and y. What is not symmetric of it
  /// is a turn.
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  int body = 0;
  double deviation = 0.005;  ///< standard deviation of a block's mean [g]
  int patch = -1;            ///< number of the patch to which the cell is tied; -1: none
  Eigen::Matrix3d R_PC = Eigen::Matrix3d::Identity();  ///< orientation of the cell in the patch
  Eigen::Vector3d p_PC = Eigen::Vector3d::Zero();

  [[nodiscard]] FittedCell moved(const CellVector& d) const {
    FittedCell out = *this;
    out.Q = straightened(Q * turn(d.head<3>()));
    out.p += d.segment<3>(3), out.b += d.segment<3>(6), out.s += d.segment<3>(9);
    out.x += d.tail<3>();
    return out;
  }
};
struct FittedPatch {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
};

struct CellFitSettings {
  double bias = 0.040, scale = 0.015;       ///< standard deviations before the data [g], [1]
  double cross_axis = 0.003;                ///< deviation of one axis by another, before symmetrisation
  double tie_position = 0.5e-3;             ///< standard deviation of a cell's place in the patch [m]
  double tie_turn = 0.0175;                 ///< standard deviation of a cell's turn in the patch [rad]
  double weak_position = 1, weak_turn = 1;  ///< priors about the start, if the data show nothing [m], [rad]
  int steps = 30;
  double decrease = 0.1;  ///< decrease of the cost below which the fit ends [variances]
  double window = 1;      ///< window of the jackknife [s]
};

/// The unknowns: those of the motion, six a patch, `cell_unknowns` a cell; the cells are eliminated.
struct CellEquations {
  Eigen::MatrixXd H;  ///< normal matrix of motion and patches
  Eigen::VectorXd g;
  std::vector<Eigen::MatrixXd> cell_H;
  std::vector<CellVector> cell_g;
  std::vector<Eigen::MatrixXd> cross;  ///< normal matrix of motion and patches by cell
  double cost = 0;
  std::vector<double> squares;  ///< sum of squares of a cell's residuals [g^2]
};

/// Ties cell number `c` to its place in a patch, whose unknowns begin at `at`.
inline void tie(const FittedCell& cell, std::size_t c, const FittedPatch& patch, Eigen::Index at,
                const CellFitSettings& settings, CellEquations& e) {
  const double wp = 1 / (settings.tie_position * settings.tie_position),
               wt = 1 / (settings.tie_turn * settings.tie_turn);
  const Eigen::Vector3d arm = patch.R * cell.p_PC;
  const Eigen::Vector3d rp = cell.p - patch.p - arm;
  const Eigen::Matrix3d R = patch.R * cell.R_PC;
  const Eigen::Vector3d rt = turn_vector(R.transpose() * cell.Q);
  const Eigen::Matrix3d across = cross_matrix(arm);
  // By the cell it is 1 (turns: small).
  Eigen::MatrixXd by_patch = Eigen::MatrixXd::Zero(6, 6);
  double r[6], w[6];
  for (int i = 0; i < 3; ++i) {
    r[i] = rt(i), r[3 + i] = rp(i), w[i] = wt, w[3 + i] = wp;
    by_patch(3 + i, 3 + i) = -1;
    for (int j = 0; j < 3; ++j) by_patch(i, j) = -cell.Q(j, i), by_patch(3 + i, j) = across(i, j);
  }
  for (int i = 0; i < 6; ++i) {
    e.cost += 0.5 * r[i] * w[i] * r[i];
    e.cell_H[c](i, i) += w[i];
    e.cell_g[c](i) -= w[i] * r[i];
    for (int j = 0; j < 6; ++j) {
      e.g(at + j) -= by_patch(i, j) * w[i] * r[i];
      e.cross[c](at + j, i) += by_patch(i, j) * w[i];
      for (int k = 0; k < 6; ++k) e.H(at + j, at + k) += by_patch(i, j) * w[i] * by_patch(i, k);
    }
  }
}

/// Solves `H x = g` by elimination of the cells; factorised once.
class CellSolver {
 public:
  bool factorise(const CellEquations& e, double damping) {
    const auto n = e.H.rows();
    Eigen::MatrixXd S = e.H;
    for (Eigen::Index i = 0; i < n; ++i) S(i, i) += damping * (e.H(i, i) + 1e-12);
    cells_.resize(e.cell_H.size());
    through_.resize(e.cell_H.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      Eigen::MatrixXd A = e.cell_H[c];
      for (int i = 0; i < cell_unknowns; ++i) A(i, i) *= 1 + damping;
      cells_[c].compute(A);
      if (!cells_[c].positive()) return false;
      through_[c] = cells_[c].solve(e.cross[c].transpose());  // cell_unknowns x n
      S.noalias() -= e.cross[c] * through_[c];
    }
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < j; ++i) S(i, j) = S(j, i) = 0.5 * (S(i, j) + S(j, i));
    size_ = n;
    schur_.compute(S);
    return n == 0 || schur_.positive();
  }
  /// Solves for one right side: the motion's part in `g`, cells in `cell_g`; both are overwritten by the
  /// solution.
  void solve(Eigen::VectorXd& g, std::vector<CellVector>& cell_g) const {
    for (std::size_t c = 0; c < cells_.size(); ++c) g.noalias() -= through_[c].transpose() * cell_g[c];
    if (g.size() > 0) g = schur_.solve(g);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      cell_g[c] = cells_[c].solve(cell_g[c]);
      cell_g[c].noalias() -= through_[c] * g;
    }
  }
  [[nodiscard]] Eigen::MatrixXd motion_covariance() const {
    return schur_.solve(Eigen::MatrixXd::Identity(size_, size_));
  }
  [[nodiscard]] Eigen::MatrixXd cell_covariance(std::size_t c, const Eigen::MatrixXd& motion) const {
    Eigen::MatrixXd own = cells_[c].inverse();
    const Eigen::MatrixXd moved = through_[c] * motion;
    own.noalias() += moved * through_[c].transpose();
    return own;
  }

 private:
  std::vector<Cholesky> cells_;
  std::vector<Eigen::MatrixXd> through_;
  Cholesky schur_;
  Eigen::Index size_ = 0;
};

/// The weights of a body's first 13 columns in the readings of a cell along its three axes, and their
/// derivatives by the cell.
struct CellWeights {
  Eigen::VectorXd c[3];        // 13
  Eigen::MatrixXd by_cell[3];  // 13 x cell_unknowns

  explicit CellWeights(const FittedCell& cell) {
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(13, 3);  // of Q' (A + S p)
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a) {
        q(a, k) = cell.Q(a, k);
        for (int b = 0; b < 3; ++b) q(3 + 3 * a + b, k) = cell.Q(a, k) * cell.p(b);
      }
    for (int k = 0; k < 3; ++k) {
      const double scale = 1 + cell.s(k);
      const int axes[3] = {k, (k + 1) % 3, (k + 2) % 3};
      const double share[3] = {1, cell.x(axes[2]), cell.x(axes[1])};  // of the row of 1 + X
      c[k] = Eigen::VectorXd::Zero(13);
      auto& D = by_cell[k];
      D.setZero(13, cell_unknowns);
      for (int i = 0; i < 3; ++i) {
        const int axis = axes[i], next = axes[(i + 1) % 3], last = axes[(i + 2) % 3];
        const double part = scale * share[i];
        for (int row = 0; row < 13; ++row) {
          c[k](row) += part * q(row, axis);
          // A turn d of the sensor: Q'f x d.
          D(row, last) += part * q(row, next), D(row, next) -= part * q(row, last);
          D(row, 9 + k) += share[i] * q(row, axis);
          if (i > 0) D(row, 12 + axes[3 - i]) = scale * q(row, axis);
        }
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) D(3 + 3 * a + b, 3 + b) += part * cell.Q(a, axis);
      }
      c[k](12) += cell.b(k);
      D(12, 6 + k) = 1;
    }
  }
};

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
