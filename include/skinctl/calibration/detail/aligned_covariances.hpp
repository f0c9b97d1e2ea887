// SPDX-License-Identifier: BSD-3-Clause
// How well a reconstruction knows the poses that it found.
#pragma once

#include <algorithm>

#include "skinctl/calibration/detail/patch_fit.hpp"
#include "skinctl/calibration/sparse_inverse.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Sets the covariances of the cells' poses, with the patch as a whole aligned. Cells that are not known have
/// no part in the alignment.
inline void aligned_covariances(const PatchFit& fit, const SparseNormal& normal,
                                std::vector<ReconstructedCell>& cells, const ReconstructionSettings& s) {
  const SparseNormal::Matrix H = normal.information();
  const SparseInverse C(H);
  const SparseNormal::Solver solver(H);
  const std::size_t n = cells.size();
  using Matrix = Eigen::MatrixXd;
  const auto motion = [&](std::size_t i) {  // of a cell when the patch moves: place, turn in its axes
    Matrix G = Matrix::Identity(6, 6);
    const Eigen::Matrix3d across = cross_matrix(cells[i].p);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) G(r, 3 + c) = -across(r, c), G(3 + r, 3 + c) = cells[i].R(c, r);
    return G;
  };
  const double place = 1 / (3e-4 * 3e-4), angle = 1 / (0.0174 * 0.0174);
  std::vector<bool> out(n, false);
  for (int round = 0; round < 6; ++round) {
    Matrix A = Matrix::Zero(6, 6), right = Matrix::Zero(H.rows(), 6);
    for (std::size_t i = 0; i < n; ++i) {
      if (out[i]) continue;
      const Matrix G = motion(i);
      Matrix WG = G;
      for (int r = 0; r < 6; ++r) WG.row(r) *= r < 3 ? place : angle;
      A += G.transpose() * WG;
      if (const int at = fit.pose_column(i); at >= 0) right.middleRows(at, 6) = WG;
    }
    const Matrix aligned = right * solve_symmetric(A, Matrix::Identity(6, 6));  // the alignment is aligned' e
    const Matrix with = solver.solve(aligned);
    const Matrix own = aligned.transpose() * with;
    std::vector<double> score(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Matrix G = motion(i), G_own = G * own;
      Matrix cov = G_own * G.transpose();
      if (const int at = fit.pose_column(i); at >= 0) {
        const Matrix part = with.middleRows(at, 6), cross = part * G.transpose(),
                     block = C.block(at, 6, at, 6);
        for (int c = 0; c < 6; ++c)
          for (int r = 0; r < 6; ++r) cov(r, c) += block(r, c) - cross(r, c) - cross(c, r);
      }
      for (int c = 0; c < 6; ++c)
        for (int r = 0; r < 6; ++r) cells[i].covariance(r, c) = 0.5 * (cov(r, c) + cov(c, r));
      score[i] =
          std::max(cells[i].place_deviation() / s.place_limit, cells[i].turn_deviation() / s.turn_limit);
    }
    auto sorted = score;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(n / 2), sorted.end());
    const double limit = std::max(1.0, 1.5 * sorted[n / 2]);
    bool more = false;
    for (std::size_t i = 0; i < n; ++i)
      if (!out[i] && !(score[i] <= limit)) out[i] = more = true;
    if (!more) break;
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
