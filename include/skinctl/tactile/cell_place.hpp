// SPDX-License-Identifier: BSD-3-Clause
// The places of a skin's cells.
#pragma once

#include <tuple>
#include <vector>

#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The place of a cell of a skin: its link, the number of its patch, its origin [m] and its outward normal
/// along the link's axes.
struct CellPlace {
  std::size_t link = 0, patch = 0;
  Xyz<double> place{0.0, 0.0, 0.0}, normal{0.0, 0.0, 1.0};
};

/// The places of all cells in the order of the patches, which is that of a skin's cell indices.
template <std::size_t... Ix, std::size_t... N, class Kind>
[[nodiscard]] SKINCTL_COLD std::vector<CellPlace> cell_places(const Patch<Ix, N, Kind>&... patch) {
  std::vector<CellPlace> all;
  all.reserve((std::size_t(0) + ... + N));
  std::size_t number = 0;
  const auto add = [&](std::size_t link, const std::vector<detail::AnyCell>& cells) {
    for (const detail::AnyCell& c : cells) all.push_back({link, number, c.X_LC.origin(), c.X_LC.axis_z()});
    ++number;
  };
  (add(Ix, patch.any()), ...);
  return all;
}
/// The places of patches in a tuple, such as those of `ur5::skin_patches`.
template <std::size_t... Ix, std::size_t... N, class Kind>
[[nodiscard]] SKINCTL_COLD std::vector<CellPlace> cell_places(
    const std::tuple<Patch<Ix, N, Kind>...>& patches) {
  return std::apply([](const auto&... patch) { return cell_places(patch...); }, patches);
}

SKINCTL_END_NAMESPACE
