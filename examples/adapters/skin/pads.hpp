// Cells of a skin file as cells of another kind than the hexagon.
#pragma once

#include <cstddef>
#include <vector>

#include "skinctl/io/skin_placement.hpp"

namespace adapters::skin {

/// The patches of a file, on the links on which `place_skin` has placed them, for a `SkinOf` of cells of
/// `Kind`. The file's gain of force, times the cell's own, is the gain of every channel in which the world
/// pushes: 1 where amounts are newtons; its gain of proximity that of channels that see. Masked cells are
/// masked; a threshold of a cell, which is one of hexagons, has no part.
template <skinctl::SensorKind Kind>
[[nodiscard]] std::vector<skinctl::ChannelPatch<Kind>> pads_of(
    const skinctl::SkinFile& file, const std::vector<skinctl::PlacedSkinPatch>& placed) {
  std::vector<skinctl::ChannelPatch<Kind>> out;
  for (const auto& p : placed) {
    const auto& patch = file.patches[p.patch];
    const auto gains = [&](double own) {
      skinctl::GainsOf<Kind> g;
      for (std::size_t c = 0; c < g.channel.size(); ++c)
        g.channel[c] =
            own * (skinctl::KindTable<Kind>::is_seen(c) ? patch.gains.proximity : patch.gains.force);
      return g;
    };
    skinctl::ChannelPatch<Kind> made{p.link, gains(1), {}};
    for (std::size_t i = 0; i < p.cells.size(); ++i) {
      const auto& cell = patch.cells[i];
      made.cells.push_back({.id = p.cells[i].id, .X_LC = p.cells[i].X_LC, .masked = !cell.masked.empty()});
      if (cell.gain != 1) made.cells.back().gains = gains(cell.gain);
    }
    out.push_back(std::move(made));
  }
  return out;
}

}  // namespace adapters::skin
