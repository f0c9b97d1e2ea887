// Filling in: what a masked cell would read, from its neighbours.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/tactile/cell_graph.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A masked cell i counts as if it read `s_i = sum_j w_ij s_j` over its neighbours, with `w_ij >= 0` of sum <= 1: its
/// unit wrench times that. This is the same as `w_ij u_i` added to the unit wrench u_j of each neighbour, so the
/// torque is linear in the readings. Weights are multiples of 2^-24. Where neighbours are masked too, the others'
/// weights are raised to the same sum. Immutable.
///
/// A contact smaller than the distance of two cells cannot be filled in.
class FillIn {
 public:
  static constexpr double unit = 1.0 / (1 << 24);

  /// Nothing is filled in.
  FillIn() = default;
  /// The mean of the neighbours.
  SKINCTL_COLD explicit FillIn(const CellGraph& graph) : graph_(graph) {
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (std::size_t k = 0; k < graph.neighbours(i).size(); ++k)
        add(1.0 / static_cast<double>(graph.neighbours(i).size()));
    close();
  }
  /// Learnt from recordings: for each cell the weights that minimise `sum (s_i - sum_j w_ij s_j)^2 + ridge sum w^2`,
  /// none below 0 (clamped, and the others solved again), with a sum of 1 at most. A cell that was never touched
  /// takes the mean of its neighbours.
  ///
  /// @param frames  readings of all cells, frame by frame, 0 where nothing touches: `frames.size()` is a multiple of
  ///   the number of cells.
  /// @param ridge   in units of the mean of the neighbours' squared readings, > 0.
  SKINCTL_COLD FillIn(const CellGraph& graph, std::span<const float> frames, double ridge = 0.03)
      : graph_(graph) {
    const std::size_t cells = graph.size(), count = cells > 0 ? frames.size() / cells : 0;
    require(cells > 0 && frames.size() == count * cells, "FillIn: readings", double(frames.size()),
            "a multiple of the number of cells");
    require(ridge > 0 && ridge <= 100, "FillIn: ridge", ridge, "> 0, <= 100");
    for (const float x : frames) require(x >= 0 && x - x == 0, "FillIn: reading", double(x), ">= 0");
    for (std::size_t i = 0; i < cells; ++i) {
      const auto near = graph.neighbours(i);
      for (const double w : learnt(frames, cells, count, i, near, ridge)) add(w);
    }
    close();
  }

  /// Weight of the `k`-th neighbour of cell `i`.
  [[nodiscard]] double weight(std::size_t i, std::size_t k) const noexcept {
    return unit * weights_[first_[i] + k];
  }
  [[nodiscard]] const CellGraph& graph() const noexcept { return graph_; }

  /// `s_i`, for readings `reading(j)` of the neighbours for which `counts(j)`; 0 if none does.
  template <class Reading, class Counts>
  [[nodiscard]] double filled(std::size_t i, const Reading& reading, const Counts& counts) const noexcept {
    if (i >= graph_.size()) return 0;
    const auto near = graph_.neighbours(i);
    const std::uint32_t* w = weights_.data() + first_[i];
    double sum = 0, all = 0, used = 0;
    for (std::size_t k = 0; k < near.size(); ++k) {
      all += w[k];
      if (!counts(near[k])) continue;
      used += w[k];
      sum += w[k] * static_cast<double>(reading(near[k]));
    }
    return used > 0 ? unit * (all / used) * sum : 0;
  }

 private:
  /// Normal equations, solved by Cholesky; negative weights leave one after the other.
  SKINCTL_COLD static std::vector<double> learnt(std::span<const float> frames, std::size_t cells,
                                                 std::size_t count, std::size_t i,
                                                 std::span<const CellGraph::Index> near, double ridge) {
    const std::size_t n = near.size();
    std::vector<double> A(n * n), b(n), w(n);
    double own = 0, energy = 0;
    for (std::size_t f = 0; f < count; ++f) {
      const float* s = frames.data() + f * cells;
      own += double(s[i]) * double(s[i]);
      for (std::size_t k = 0; k < n; ++k) {
        b[k] += double(s[near[k]]) * double(s[i]);
        for (std::size_t l = 0; l < n; ++l) A[k * n + l] += double(s[near[k]]) * double(s[near[l]]);
      }
    }
    for (std::size_t k = 0; k < n; ++k) energy += A[k * n + k] / static_cast<double>(n);
    if (!(own > 0) || !(energy > 0))
      return std::vector<double>(n, n > 0 ? 1.0 / static_cast<double>(n) : 0.0);
    for (std::size_t k = 0; k < n; ++k) A[k * n + k] += ridge * energy;
    std::vector<bool> in(n, true);
    for (std::size_t round = 0; round <= n; ++round) {
      w = solved(A, b, in);
      bool good = true;
      for (std::size_t k = 0; k < n; ++k)
        if (w[k] < 0) in[k] = good = false;
      if (good) break;
    }
    double sum = 0;
    for (const double x : w) sum += x;
    if (sum > 1)
      for (double& x : w) x /= sum;
    return w;
  }
  SKINCTL_COLD static std::vector<double> solved(const std::vector<double>& A, const std::vector<double>& b,
                                                 const std::vector<bool>& in) {
    const std::size_t n = b.size();
    std::vector<double> L(n * n), y(n), w(n);
    for (std::size_t k = 0; k < n; ++k) {
      if (!in[k]) continue;
      for (std::size_t l = 0; l <= k; ++l) {
        if (!in[l]) continue;
        double x = A[k * n + l];
        for (std::size_t m = 0; m < l; ++m) x -= L[k * n + m] * L[l * n + m];
        L[k * n + l] = k == l ? std::sqrt(x) : x / L[l * n + l];
      }
      double x = b[k];
      for (std::size_t m = 0; m < k; ++m) x -= L[k * n + m] * y[m];
      y[k] = x / L[k * n + k];
    }
    for (std::size_t k = n; k-- > 0;) {
      if (!in[k]) continue;
      double x = y[k];
      for (std::size_t m = k + 1; m < n; ++m) x -= L[m * n + k] * w[m];
      w[k] = x / L[k * n + k];
    }
    return w;
  }
  SKINCTL_COLD void add(double w) { weights_.push_back(static_cast<std::uint32_t>(std::floor(w / unit))); }
  SKINCTL_COLD void close() {
    first_.assign(1, 0);
    for (std::size_t i = 0; i < graph_.size(); ++i)
      first_.push_back(first_.back() + static_cast<std::uint32_t>(graph_.neighbours(i).size()));
  }

  CellGraph graph_;
  std::vector<std::uint32_t> weights_, first_;
};

SKINCTL_END_NAMESPACE
