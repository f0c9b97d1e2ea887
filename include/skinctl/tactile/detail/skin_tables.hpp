// SPDX-License-Identifier: BSD-3-Clause
// The constant data of a skin: its cells by id, its patches.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "skinctl/tactile/channel_calibration.hpp"
#include "skinctl/tactile/detail/cell_row.hpp"
#include "skinctl/tactile/detail/held_signal.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A cell as a skin was given it.
template <class Kind>
struct GivenCell {
  AnyCell placed;
  PerChannel<Kind, EventGate<>> gates;
  PerChannel<Kind, double> gain;  ///< gain of each channel [N] per unit of it
  bool masked = false;            ///< whether the cell is excluded
};

/// All cells of a skin, in the order of their patches.
template <class Kind, Real T>
struct SkinTables {
  using Table = KindTable<Kind>;
  static constexpr std::uint32_t highest_id = (1u << 20) - 1;

  SampledTimes times;
  std::vector<PatchRow<Kind, T>> patches;
  std::vector<CellRow<Kind>> cells;
  std::vector<Xyz<float>> origins;            ///< origin of each cell on its link [m]
  std::vector<std::uint32_t> numb;            ///< cells without gains: they are heard, and do not feel
  std::vector<std::uint32_t> by_id = {none};  ///< cell's index for each id; the last one is `none`
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  std::vector<ChannelCalibration<Kind>> calibration;  ///< calibration of each cell, one for all, or none
  std::vector<GivenCell<Kind>> given;                 ///< cells as given, for wrappers; not for the loop

  /// Reserves room for `count` cells.
  SKINCTL_COLD void reserve(std::size_t count) {
    cells.reserve(count), origins.reserve(count), given.reserve(count), by_id.reserve(count + 2);
  }
  /// Adds a patch on link `link`. `gain` is no less than the gains of its cells, which are kept as shares of
  /// it.
  SKINCTL_COLD void add(const std::vector<GivenCell<Kind>>& patch, const PerChannel<Kind, double>& gain,
                        std::size_t link, std::size_t slot) {
    require(patches.size() < 0xFFFF, "Skin: patches", double(patches.size() + 1), "at most 65535");
    const int reach = reach_of(patch);
    PatchRow<Kind, T> row;
    row.moment_step = static_cast<T>(std::ldexp(1.0, reach - 24));
    row.first = static_cast<std::uint32_t>(cells.size()),
    row.count = static_cast<std::uint32_t>(patch.size());
    row.link = static_cast<std::uint32_t>(link), row.slot = static_cast<std::uint32_t>(slot);
    for (std::size_t c = 0; c < Table::pushing; ++c)
      row.newton[c] = gain[c] * Table::step(c), row.gain[c] = static_cast<T>(row.newton[c]);
    for (const GivenCell<Kind>& cell : patch) {
      const std::uint32_t id = cell.placed.id;
      require(id <= highest_id, "Skin: cell id", double(id), "< 2^20");
      if (id + 1 >= by_id.size()) by_id.resize(id + 2, none);
      require(by_id[id] == none, "Skin: cell id", double(id), "ids that occur once");
      by_id[id] = static_cast<std::uint32_t>(cells.size());
      add_cell(cell, gain, reach, row);
      given.push_back(cell);
    }
    patches.push_back(row);
  }

  /// Index of a cell by its id; `none` for an unknown one.
  [[nodiscard]] SKINCTL_INLINE std::uint32_t index(std::uint32_t id) const noexcept {
    const std::size_t last = by_id.size() - 1;
    return by_id[id < last ? id : last];
  }
  SKINCTL_INLINE const PatchRow<Kind, T>& patch_of(std::size_t i) const noexcept {
    return patches[cells[i].patch];
  }

  /// The amounts of cell `i`, of a sample that passed `check`.
  [[nodiscard]] SKINCTL_INLINE PerChannel<Kind, float> amounts(std::size_t i,
                                                               const SampleOf<Kind>& sample) const noexcept {
    const auto& x = readings_of(sample);
    if (!calibration.empty()) [[unlikely]]
      return calibration[calibration.size() == 1 ? 0 : i].amounts(x.data());
    PerChannel<Kind, float> out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA { out[c] = amount_of<Kind, c>(x.data()); });
    return out;
  }
  [[nodiscard]] SKINCTL_INLINE PerChannel<Kind, std::uint16_t> counts(
      std::size_t i, const SampleOf<Kind>& sample) const noexcept {
    const PerChannel<Kind, float> amount = amounts(i, sample);
    PerChannel<Kind, std::uint16_t> out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA { out[c] = count_of<Kind, c>(amount[c]); });
    return out;
  }
  /// Whether another skin has the same cells at the same places.
  [[nodiscard]] bool same_cells(const SkinTables& other) const noexcept {
    bool same = by_id == other.by_id && cells.size() == other.cells.size();
    for (std::size_t i = 0; same && i < cells.size(); ++i)
      same = cells[i].unit == other.cells[i].unit && cells[i].patch == other.cells[i].patch &&
             patch_of(i).link == other.patch_of(i).link &&
             double(patch_of(i).moment_step) == double(other.patch_of(i).moment_step);
    return same;
  }

 private:
  /// Force and moment about the link's origin of one newton along a channel's direction, eqs. (4) and (6).
  [[nodiscard]] static std::pair<Xyz<double>, Xyz<double>> push_along(const AnyCell& cell, std::size_t line) {
    std::size_t c = 0;
    while (Table::line[c] != line) ++c;
    const auto& d = Kind::channels[c].direction;
    const auto& at = Kind::channels[c].place;
    const auto axes = cell.X_LC.axes();
    const Xyz<double> force = d[0] * axes.x + d[1] * axes.y + d[2] * axes.z;
    const Xyz<double> p = cell.X_LC.origin() + at[0] * axes.x + at[1] * axes.y + at[2] * axes.z;
    return {force, cross(p, force)};
  }
  /// The smallest exponent >= -20 with which the moments of a patch's unit wrenches are at most 2^exponent
  /// [m].
  [[nodiscard]] SKINCTL_COLD static int reach_of(const std::vector<GivenCell<Kind>>& patch) {
    int reach = -20;
    for (const GivenCell<Kind>& cell : patch)
      for (std::size_t line = 0; line < Table::lines; ++line) {
        const Xyz<double> m = push_along(cell.placed, line).second;
        for (const double x : {m.x, m.y, m.z})
          while (std::abs(x) > std::ldexp(1.0, reach)) ++reach;
      }
    return reach;
  }
  SKINCTL_COLD void add_cell(const GivenCell<Kind>& cell, const PerChannel<Kind, double>& gain, int reach,
                             PatchRow<Kind, T>& patch) {
    CellRow<Kind> row;
    row.patch = static_cast<std::uint16_t>(patches.size()), row.slot = static_cast<std::uint16_t>(patch.slot);
    const auto whole = [](double x, int exponent) {
      return static_cast<std::int32_t>(std::round(std::ldexp(x, 24 - exponent)));
    };
    for (std::size_t line = 0; line < Table::lines; ++line) {
      const auto [f, m] = push_along(cell.placed, line);
      row.unit[line] = {whole(f.x, 0),     whole(f.y, 0),     whole(f.z, 0),
                        whole(m.x, reach), whole(m.y, reach), whole(m.z, reach)};
    }
    bool feels = false;
    for (std::size_t c = 0; c < Table::pushing; ++c) {
      const auto gate = cell.gates[c].counted(Table::step(c));
      const double own = cell.masked ? 0 : cell.gain[c], share = gain[c] > 0 ? own / gain[c] : 1;
      row.tuning[c].set(gate);
      row.tuning[c].share = static_cast<std::uint16_t>(std::round(share * double(ChannelTuning::whole)));
      feels = feels || own > 0;
      patch.hidden[c] = gate.opens_at() > patch.hidden[c] ? gate.opens_at() : patch.hidden[c];
    }
    if (!feels) numb.push_back(static_cast<std::uint32_t>(cells.size()));
    cells.push_back(row);
    const Xyz<double>& p = cell.placed.X_LC.origin();
    origins.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
