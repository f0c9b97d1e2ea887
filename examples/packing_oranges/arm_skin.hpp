// The skin of an arm: a cell that nobody hears is watched by its neighbours.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "skinctl/skinctl.hpp"

namespace packing {

/// Share of a push on the middle of a cell that the cover brings to each of its neighbours.
inline constexpr double spread = 0.07;

/// The neighbours of each cell: those of its link at most 1.4 times as far away as the nearest one.
[[nodiscard]] inline std::vector<std::vector<std::size_t>> neighbours(
    const std::vector<skinctl::CellPlace>& places) {
  const auto far = [&](std::size_t i, std::size_t j) {
    return places[i].link == places[j].link ? norm(skinctl::Xyz<double>(places[i].place - places[j].place))
                                            : 1e9;
  };
  std::vector<std::vector<std::size_t>> out(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    double nearest = 1e8;
    for (std::size_t j = 0; j < places.size(); ++j)
      if (j != i) nearest = std::min(nearest, far(i, j));
    for (std::size_t j = 0; j < places.size(); ++j)
      if (j != i && far(i, j) <= 1.4 * nearest) out[i].push_back(j);
  }
  return out;
}

/// `Cells`, the first of which feel, and whose neighbours notice `spread` of what pushes them.
template <class Cells>
class ArmSkin : public Cells {
 public:
  /// @param feel  number of the cells that feel.
  ArmSkin(const Cells& all, std::size_t feel) : Cells(all), near_(neighbours(felt(feel))) {}

  /// Places of the cells that feel.
  [[nodiscard]] std::vector<skinctl::CellPlace> felt(std::size_t count) const {
    auto out = this->places();
    out.resize(count);
    return out;
  }
  /// The least reading of a push on the middle of cell `i` that it or a neighbour notices.
  [[nodiscard]] double noticed(const typename Cells::Memory& m, std::size_t i) const noexcept {
    double least = Cells::noticed(m, i);
    if (i >= near_.size()) return least;
    for (const std::size_t j : near_[i]) least = std::min(least, Cells::noticed(m, j) / spread);
    return least;
  }

 private:
  std::vector<std::vector<std::size_t>> near_;
};

}  // namespace packing
