// SPDX-License-Identifier: BSD-3-Clause
// Filling in: what a masked cell would read, from the cells around it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/tactile/cell_graph.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Readings in place of those of masked cells. A masked cell i counts as if it read `s_i = sum_j w_ij s_j`,
/// the weighted sum of the readings s_j of the cells j around it, limited to the range of 0 and these
/// readings. Weights are multiples of 2^-24. A cell around it that is masked too reads the mean of its own
/// neighbours, or if these are masked the mean of the others around i. Immutable.
///
/// A contact smaller than the distance of two cells cannot be filled in.
class FillIn {
 public:
  static constexpr double unit = 1.0 / (1 << 24);
  static constexpr std::size_t max_around = 24;  ///< maximum number of cells around one: the nearest

  /// A filling-in of no cell, for skins without masks.
  FillIn() = default;
  /// A cell is filled in with the mean of its neighbours.
  SKINCTL_COLD explicit FillIn(const CellGraph& graph) : graph_(graph) {
    for (std::size_t i = 0; i < graph.size(); ++i) {
      const auto near = graph.neighbours(i);
      for (const CellGraph::Index j : near) add(j, 1.0 / static_cast<double>(near.size()));
      end();
    }
  }
  /// A cell is filled in from its neighbours and their neighbours that face to the same side, with the best
  /// linear estimate for a random field of the correlation `(1 + x) exp(-x)`, `x = sqrt(3) d / 2p` (Matern
  /// 3/2), where readings have noise of a tenth of the field's deviation: `(K + 0.01 I) w_i = k_i`, with the
  /// correlations K of these cells with each other and k_i with cell i. d is the distance of two cells, p the
  /// mean distance of cell i from its neighbours. Pressure is curved: weights of the second ring are
  /// negative.
  ///
  /// @param places  places of the graph's cells, in their order; another number throws `ConfigurationError`.
  SKINCTL_COLD FillIn(const CellGraph& graph, std::span<const CellPlace> places) : graph_(graph) {
    require(places.size() == graph.size(), "FillIn: places", double(places.size()), "one for each cell");
    for (std::size_t i = 0; i < graph.size(); ++i) {
      const auto near = graph.neighbours(i);
      const auto apart = [&](std::size_t a, std::size_t b) {
        const Xyz<double> way = places[a].place - places[b].place;
        return std::sqrt(dot(way, way));
      };
      double pitch = 0;
      for (const CellGraph::Index j : near) pitch += apart(i, j) / static_cast<double>(near.size());
      const auto correlation = [&](std::size_t a, std::size_t b) {
        const double x = pitch > 0 ? std::sqrt(0.75) * apart(a, b) / pitch : 0;
        return (1 + x) * std::exp(-x);
      };
      const auto from = two_rings(i, places);
      constexpr std::size_t n = max_around;
      std::array<double, n * n> K{};
      std::array<double, n> k{}, w{};
      for (std::size_t a = 0; a < n; ++a) {
        K[a * n + a] = 1.01;  // where there is no cell, too: its weight is 0
        if (a >= from.size()) continue;
        k[a] = correlation(i, from[a]);
        for (std::size_t b = 0; b < a; ++b) K[a * n + b] = correlation(from[a], from[b]);
      }
      math::Ldlt<n>(K.data()).solve(k.data(), w.data());
      for (std::size_t a = 0; a < from.size(); ++a) add(from[a], w[a]);
      end();
    }
  }

  /// The neighbours of each cell.
  [[nodiscard]] const CellGraph& graph() const noexcept { return graph_; }
  /// The cells around cell `i` < graph().size(), which fill it in, in rising order.
  [[nodiscard]] std::span<const CellGraph::Index> around(std::size_t i) const noexcept {
    return {around_.data() + first_[i], around_.data() + first_[i + 1]};
  }
  /// Weight w_ij of the `k`-th cell around cell `i`.
  [[nodiscard]] double weight(std::size_t i, std::size_t k) const noexcept {
    return unit * weights_[first_[i] + k];
  }

  /// The reading s_i that fills in cell `i`, from the readings `reading(j)` >= 0 of the cells around it for
  /// which `counts(j)`; 0 if none does.
  template <class Reading, class Counts>
  [[nodiscard]] double filled(std::size_t i, const Reading& reading, const Counts& counts) const noexcept {
    const auto one = [&](std::size_t j) { return std::array{static_cast<double>(reading(j))}; };
    return filled_with(i, counts, [&](std::size_t j) { return read_as(j, one, counts); })[0];
  }
  /// The readings that fill in cell `i`, several at once. `value(j)` is `read_as(j, ...)`; a caller may keep
  /// it, because each cell that has j around it asks for it.
  template <class Counts, class Value>
  [[nodiscard]] auto filled_with(std::size_t i, const Counts& counts, const Value& value) const noexcept {
    using Values = std::remove_cvref_t<decltype(value(i))>;
    constexpr std::size_t K = std::tuple_size_v<Values>;
    Values out{};
    if (i >= graph_.size()) return out;
    const auto from = around(i);
    if (std::none_of(from.begin(), from.end(), counts)) return out;
    const std::int32_t* w = weights_.data() + first_[i];
    double sum[K] = {}, all[K] = {}, least[K] = {}, most[K] = {}, known = 0, unknown = 0;
    for (std::size_t k = 0; k < from.size(); ++k) {
      const Values s = value(from[k]);
      if (!(s[0] == s[0])) {
        unknown += w[k];
        continue;
      }
      known += 1;
      for (std::size_t r = 0; r < K; ++r) {
        const double x = s[r];
        sum[r] += w[k] * x, all[r] += x, most[r] = x > most[r] ? x : most[r],
                                         least[r] = x < least[r] ? x : least[r];
      }
    }
    for (std::size_t r = 0; r < K; ++r) {
      const double x = unit * (sum[r] + unknown * (all[r] / known));
      out[r] = static_cast<typename Values::value_type>(x < least[r] ? least[r] : x < most[r] ? x : most[r]);
    }
    return out;
  }
  /// The readings by which cell `j` fills in others: its own, an array, if it counts, else the means of those
  /// of its neighbours that count, NaN if none does.
  template <class Readings, class Counts>
  [[nodiscard]] auto read_as(std::size_t j, const Readings& readings, const Counts& counts) const noexcept {
    using Values = std::remove_cvref_t<decltype(readings(j))>;
    if (counts(j)) return Values(readings(j));
    Values mean{};
    typename Values::value_type known = 0;
    for (const CellGraph::Index n : graph_.neighbours(j)) {
      if (!counts(n)) continue;
      const Values s = readings(n);
      for (std::size_t r = 0; r < mean.size(); ++r) mean[r] += s[r];
      known += 1;
    }
    for (auto& x : mean)
      x = known > 0 ? x / known : std::numeric_limits<typename Values::value_type>::quiet_NaN();
    return mean;
  }

 private:
  SKINCTL_COLD void add(CellGraph::Index from, double w) {
    around_.push_back(from);
    weights_.push_back(static_cast<std::int32_t>(std::floor(w / unit)));
  }
  SKINCTL_COLD void end() { first_.push_back(static_cast<CellGraph::Index>(around_.size())); }
  /// The neighbours of cell `i` and their neighbours that face to its side: of more than `max_around` the
  /// nearest.
  [[nodiscard]] SKINCTL_COLD std::vector<CellGraph::Index> two_rings(
      std::size_t i, std::span<const CellPlace> places) const {
    std::vector<CellGraph::Index> from;
    const auto take = [&](CellGraph::Index j) {
      if (j != i && dot(places[i].normal, places[j].normal) > 0) from.push_back(j);
    };
    for (const CellGraph::Index j : graph_.neighbours(i)) {
      take(j);
      for (const CellGraph::Index k : graph_.neighbours(j)) take(k);
    }
    std::sort(from.begin(), from.end());
    from.erase(std::unique(from.begin(), from.end()), from.end());
    if (from.size() > max_around) {
      const auto far = [&](CellGraph::Index j) {
        const Xyz<double> way = places[j].place - places[i].place;
        return std::pair(dot(way, way), j);
      };
      std::sort(from.begin(), from.end(),
                [&](CellGraph::Index a, CellGraph::Index b) { return far(a) < far(b); });
      from.resize(max_around);
      std::sort(from.begin(), from.end());
    }
    return from;
  }
  CellGraph graph_;
  std::vector<CellGraph::Index> first_ = {0},
                                around_;  // those around i: around_[first_[i]] to around_[first_[i + 1]]
  std::vector<std::int32_t> weights_;     // in steps of 2^-24
};

SKINCTL_END_NAMESPACE
