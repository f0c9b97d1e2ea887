// The skin of an arm: a cell that nobody hears is watched by its neighbours.
#pragma once

#include <algorithm>
#include <vector>

#include "skinctl/skinctl.hpp"

namespace packing {

/// Share of a push on the middle of a cell that the cover brings to each of its neighbours.
inline const double spread = skinctl::TrustSettings{}.spread;

/// `Cells`, the first of which feel, and whose neighbours notice `spread` of what pushes them.
template <class Cells>
class ArmSkin : public Cells {
 public:
  /// @param feel  number of the cells that feel.
  ArmSkin(const Cells& all, std::size_t feel) : Cells(all), graph_(felt(feel)) {}

  /// Places of the cells that feel.
  [[nodiscard]] std::vector<skinctl::CellPlace> felt(std::size_t count) const {
    auto out = this->places();
    out.resize(count);
    return out;
  }
  /// Which of the cells that feel are neighbours.
  [[nodiscard]] const skinctl::CellGraph& graph() const { return graph_; }
  /// The least reading of a push on the middle of cell `i` that it or a neighbour notices.
  [[nodiscard]] double noticed(const typename Cells::Memory& m, std::size_t i) const noexcept {
    double least = Cells::noticed(m, i);
    if (i >= graph_.size()) return least;
    for (const std::size_t j : graph_.neighbours(i)) least = std::min(least, Cells::noticed(m, j) / spread);
    return least;
  }

 private:
  skinctl::CellGraph graph_;
};

}  // namespace packing
