// SPDX-License-Identifier: BSD-3-Clause
// Weights of filling in, learnt from recordings of a skin.
#pragma once

#include <Eigen/Cholesky>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/fill_in.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The weights >= 0 that minimise `w'A w - 2 b'w`: negative ones are set to 0, and the others are solved again.
[[nodiscard]] inline Eigen::VectorXd weights_not_below_zero(const Eigen::MatrixXd& A,
                                                            const Eigen::VectorXd& b) {
  std::vector<Eigen::Index> in;
  for (Eigen::Index k = 0; k < b.size(); ++k) in.push_back(k);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(b.size());
  for (bool good = false; !good && !in.empty();) {
    const Eigen::VectorXd best = A(in, in).llt().solve(b(in));
    std::vector<Eigen::Index> kept;
    w.setZero();
    for (std::size_t k = 0; k < in.size(); ++k) {
      const double x = best(static_cast<Eigen::Index>(k));
      if (x < 0) continue;
      kept.push_back(in[k]);
      w(in[k]) = x;
    }
    good = kept.size() == in.size();
    in = kept;
  }
  return w;
}

}  // namespace detail

/// `FillIn` with the weights that for each cell minimise `sum (s_i - sum_j w_ij s_j)^2 + ridge sum w^2` over its
/// neighbours j, none below 0 (clamped, and the others solved again), with a sum of 1 at most. A cell that was never
/// touched takes the mean of its neighbours.
///
/// @param frames  readings of all cells, frame by frame, 0 where nothing touches: `frames.size()` is a multiple of
///   the number of cells.
/// @param ridge   in units of the mean of the neighbours' squared readings, > 0.
[[nodiscard]] inline FillIn learnt_fill_in(const CellGraph& graph, std::span<const float> frames,
                                           double ridge = 0.03) {
  const std::size_t cells = graph.size(), count = cells > 0 ? frames.size() / cells : 0;
  require(cells > 0 && frames.size() == count * cells, "learnt_fill_in: readings", double(frames.size()),
          "a multiple of the number of cells");
  require(ridge > 0 && ridge <= 100, "learnt_fill_in: ridge", ridge, "> 0, <= 100");
  for (const float x : frames) require(x >= 0 && x - x == 0, "learnt_fill_in: reading", double(x), ">= 0");
  const Eigen::MatrixXd s =
      Eigen::Map<const Eigen::MatrixXf>(frames.data(), Eigen::Index(cells), Eigen::Index(count))
          .cast<double>();
  std::vector<double> weights;
  for (std::size_t i = 0; i < cells; ++i) {
    const auto row = graph.neighbours(i);
    const std::vector<Eigen::Index> near(row.begin(), row.end());
    const auto n = static_cast<Eigen::Index>(near.size());
    const Eigen::MatrixXd around = s(near, Eigen::all);
    const Eigen::VectorXd own = s.row(Eigen::Index(i)).transpose();
    Eigen::MatrixXd A = around * around.transpose();
    const double energy = n > 0 ? A.trace() / double(n) : 0;
    Eigen::VectorXd w = Eigen::VectorXd::Constant(n, n > 0 ? 1 / double(n) : 0);
    if (own.squaredNorm() > 0 && energy > 0) {
      A.diagonal().array() += ridge * energy;
      w = detail::weights_not_below_zero(A, around * own);
      if (w.sum() > 1) w /= w.sum();
    }
    weights.insert(weights.end(), w.begin(), w.end());
  }
  return {graph, weights};
}

SKINCTL_END_NAMESPACE
