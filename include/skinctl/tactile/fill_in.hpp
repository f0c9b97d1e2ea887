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
    close();
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (std::size_t k = 0; k < graph.neighbours(i).size(); ++k)
        add(1.0 / static_cast<double>(graph.neighbours(i).size()));
  }
  /// With these weights, cell by cell in the order of its neighbours: >= 0, of a sum of 1 at most for each cell. They
  /// are rounded down to multiples of 2^-24. See `learnt_fill_in`.
  SKINCTL_COLD FillIn(const CellGraph& graph, std::span<const double> weights) : graph_(graph) {
    close();
    require(weights.size() == first_.back(), "FillIn: number of weights", double(weights.size()),
            "one for each neighbour of each cell");
    for (std::size_t i = 0; i < graph.size(); ++i) {
      double sum = 0;
      for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) {
        require(weights[k] >= 0 && weights[k] <= 1, "FillIn: weight", weights[k], "0 to 1");
        sum += weights[k];
        add(weights[k]);
      }
      require(sum <= 1 + 1e-9, "FillIn: sum of a cell's weights", sum, "at most 1");
    }
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
