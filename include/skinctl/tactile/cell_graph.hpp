// SPDX-License-Identifier: BSD-3-Clause
// The neighbours of each cell of a skin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

/// Whether two cells face to the same side, to within 120 degrees. Others, such as those on the two sides of
/// a plate, are no neighbours however close they are.
inline bool same_face(const CellPlace& a, const CellPlace& b) noexcept {
  return dot(a.normal, b.normal) > -0.5;
}

/// Calls `f(i, j, distance)` for each ordered pair of cells of one link and face; distance [m].
template <class F>
SKINCTL_COLD void each_pair(std::span<const CellPlace> cells, const F& f) {
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    for (std::uint32_t j = 0; j < cells.size(); ++j) {
      if (i == j || cells[i].link != cells[j].link || !same_face(cells[i], cells[j])) continue;
      const Xyz<double> way = cells[j].place - cells[i].place;
      f(i, j, std::sqrt(dot(way, way)));
    }
}

}  // namespace detail

/// The pitch of each patch [m]: the median distance of its cells from their nearest neighbour in the patch;
/// infinite for a patch of one cell.
[[nodiscard]] SKINCTL_COLD inline std::vector<double> patch_pitches(std::span<const CellPlace> cells) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::vector<double> nearest(cells.size(), far);
  detail::each_pair(cells, [&](std::uint32_t i, std::uint32_t j, double distance) {
    if (cells[i].patch == cells[j].patch) nearest[i] = std::min(nearest[i], distance);
  });
  std::size_t patches = 0;
  for (const CellPlace& c : cells) patches = std::max(patches, c.patch + 1);
  std::vector<std::vector<double>> of_patch(patches);
  for (std::size_t i = 0; i < cells.size(); ++i) of_patch[cells[i].patch].push_back(nearest[i]);
  std::vector<double> pitch(patches, far);
  for (std::size_t k = 0; k < patches; ++k) {
    auto& all = of_patch[k];
    if (all.empty()) continue;
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    pitch[k] = *middle;
  }
  return pitch;
}

/// The neighbours of each cell, by index in the order of the patches: a compressed list (CSR) whose rows are
/// in rising order. Immutable and symmetric; no cell is its own neighbour.
class CellGraph {
 public:
  using Index = std::uint32_t;

  /// A skin without neighbours: each of its `cells` stands alone.
  SKINCTL_COLD explicit CellGraph(std::size_t cells = 0) : first_(cells + 1, 0) {}

  /// Neighbours are cells of one link that face to the same side, to within 120 degrees, and lie within
  /// `pitches` times the mean of their patches' pitches (`patch_pitches`) of each other. A patch of one cell
  /// takes the other patch's pitch; two such patches take the smallest pitch of the skin. Throws
  /// `ConfigurationError` unless `pitches` is in (0, 10], and for a place that is not finite.
  SKINCTL_COLD explicit CellGraph(std::span<const CellPlace> cells, double pitches = 1.3) {
    require(pitches > 0 && pitches <= 10, "CellGraph: pitches", pitches, "> 0, <= 10");
    for (const CellPlace& c : cells) {
      const double sum = c.place.x + c.place.y + c.place.z + c.normal.x + c.normal.y + c.normal.z;
      require(sum - sum == 0, "CellGraph: place of a cell", sum, "finite m");
    }
    constexpr double far = std::numeric_limits<double>::infinity();
    const std::vector<double> pitch = patch_pitches(cells);
    const double smallest = pitch.empty() ? far : *std::min_element(pitch.begin(), pitch.end());
    const auto reach = [&](std::uint32_t i, std::uint32_t j) {
      const double a = pitch[cells[i].patch], b = pitch[cells[j].patch], mean = 0.5 * (a + b);
      const double one = std::min(a, b);
      return pitches * (mean < far ? mean : one < far ? one : smallest);
    };
    std::vector<std::vector<Index>> lists(cells.size());
    detail::each_pair(cells, [&](std::uint32_t i, std::uint32_t j, double distance) {
      const double r = reach(i, j);
      if (distance <= r && r - r == 0) lists[i].push_back(j);
    });
    store(lists);
  }

  /// The neighbours as a file lists them, cell by cell. Throws `ConfigurationError` for an index that no cell
  /// has, a cell that is its own neighbour, a neighbour that is named twice, and for a cell whose neighbour
  /// does not name it in return.
  SKINCTL_COLD explicit CellGraph(std::vector<std::vector<Index>> neighbours) {
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      auto& list = neighbours[i];
      std::sort(list.begin(), list.end());
      for (std::size_t k = 0; k < list.size(); ++k) {
        require(list[k] < neighbours.size(), "CellGraph: index of a neighbour", double(list[k]),
                "less than the number of cells");
        require(list[k] != i, "CellGraph: neighbour of itself", double(i), "another cell");
        require(k == 0 || list[k] != list[k - 1], "CellGraph: neighbour named twice", double(list[k]),
                "once");
      }
    }
    for (std::size_t i = 0; i < neighbours.size(); ++i)
      for (const Index j : neighbours[i])
        require(std::binary_search(neighbours[j].begin(), neighbours[j].end(), static_cast<Index>(i)),
                "CellGraph: neighbour of one side only", double(j), "cells that name each other");
    store(neighbours);
  }

  /// Number of cells.
  [[nodiscard]] std::size_t size() const noexcept { return first_.size() - 1; }
  /// Number of pairs of neighbours.
  [[nodiscard]] std::size_t edges() const noexcept { return to_.size() / 2; }
  /// The neighbours of cell `i` < size(), in rising order.
  [[nodiscard]] SKINCTL_INLINE std::span<const Index> neighbours(std::size_t i) const noexcept {
    return {to_.data() + first_[i], to_.data() + first_[i + 1]};
  }
  /// Whether `i` and `j` are neighbours.
  [[nodiscard]] bool joined(std::size_t i, std::size_t j) const noexcept {
    const auto row = neighbours(i);
    return std::binary_search(row.begin(), row.end(), static_cast<Index>(j));
  }
  friend bool operator==(const CellGraph&, const CellGraph&) noexcept = default;

 private:
  SKINCTL_COLD void store(std::vector<std::vector<Index>>& lists) {
    first_.assign(1, 0);
    for (auto& list : lists) {
      std::sort(list.begin(), list.end());
      to_.insert(to_.end(), list.begin(), list.end());
      first_.push_back(static_cast<Index>(to_.size()));
    }
  }

  std::vector<Index> first_, to_;  // neighbours of i: to_[first_[i]] to to_[first_[i + 1]]
};

SKINCTL_END_NAMESPACE
