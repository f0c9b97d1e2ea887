// SPDX-License-Identifier: BSD-3-Clause
// SkinOf: a skin whose cells, patches and links are known at run time, each cell with gains and thresholds.
#pragma once

#include <optional>
#include <vector>

#include "skinctl/tactile/detail/skin_core.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The frame of a link that is known at run time only.
using SomeLink = detail::AnyLink;

/// A cell of a `ChannelPatch`: its id in the samples, its pose on the link, and gains, gates and a mask of
/// its own where they differ from those of patch and skin.
template <SensorKind Kind = Hexagon>
struct ChannelCell {
  std::uint32_t id = 0;
  Transform<SomeLink, Cell> X_LC;        ///< pose of the cell on its link; z is the outward normal
  std::optional<GainsOf<Kind>> gains{};  ///< gains of the cell; none: those of its patch
  /// Gate of each channel that pushes, in its order: of a hexagon the sum of its forces, and its proximity.
  /// None: the gate of the skin's settings.
  std::array<std::optional<EventGate<>>, KindTable<Kind>::pushing> gate{};
  bool masked = false;  ///< whether the cell is excluded, whatever it sends

  /// The gates in the order of the channels: the skin's where the cell has none of its own.
  [[nodiscard]] auto gates(const SettingsOf<Kind>& s) const {
    auto out = s.gates();
    for (std::size_t c = 0; c < out.size(); ++c) out[c] = gate[c].value_or(out[c]);
    return out;
  }
};
/// Cells of a kind on link `link` with common gains. See `Patch`, which has its link and size in its type.
template <SensorKind Kind = Hexagon>
struct ChannelPatch {
  std::size_t link = 0;
  GainsOf<Kind> gains{};
  std::vector<ChannelCell<Kind>> cells;
};
using SkinCell = ChannelCell<>;
using SkinPatch = ChannelPatch<>;

namespace detail {

/// Adds patches of a skin that is not known to the compiler to its tables.
template <class Wrenches, class Kind, Real T>
SKINCTL_COLD void add_patches(SkinTables<Kind, T>& tables, const SettingsOf<Kind>& settings,
                              const std::vector<ChannelPatch<Kind>>& patches) {
  constexpr std::size_t joints = Wrenches::model_type::joints;
  for (const auto& patch : patches) {
    require(patch.link < joints && ((Wrenches::links >> patch.link) & 1u) != 0, "SkinOf: link of a patch",
            double(patch.link), "a link of this skin's type");
    require(!patch.cells.empty(), "SkinOf: cells of a patch", 0, ">= 1");
    require_gains<Kind>(patch.gains);
    auto most = gain_list(patch.gains);
    std::vector<AnyCell> placed;
    std::vector<GivenCell<Kind>> all;
    for (const auto& cell : patch.cells) {
      const auto own = cell.gains.value_or(patch.gains);
      require_gains<Kind>(own);
      const auto gain = gain_list(own);
      for (std::size_t c = 0; c < most.size(); ++c) most[c] = gain[c] > most[c] ? gain[c] : most[c];
      placed.push_back({cell.id, cell.X_LC});
      all.push_back({placed.back(), cell.gates(settings), gain, cell.masked});
    }
    require_cells(placed, placed.size());
    tables.add(all, most, patch.link, Wrenches::slot(patch.link));
  }
}
}  // namespace detail

/// A `Skin` of up to `Capacity` cells in up to `Patches` patches on links of `Links`, all known at run time:
/// from a file, say. What one cell reads is the same to the bit as in a `Skin`, and a scene takes it in its
/// place.
///
/// **Of each cell.** A threshold of its own, counted as in `EventGate::counted`; and gains of its own, as
/// shares of the largest gain in its patch, in steps of 2^-15. A share that is no whole step is off by at
/// most 2^-16, and a shared reading by half a count more. Where all cells of a patch have one gain nothing is
/// rounded. One that is masked, or has no gain, neither pushes nor counts as `usable`: it does not feel.
///
/// The memory is sized for `Capacity`, 17 bytes a cell, and 96 bytes a patch, whatever is used of it. A
/// robot's link without cells has a wrench of zero, and `max_proximity` on it is 1: nothing is known of it.
template <Topology M, Real T, std::size_t Capacity, std::size_t Patches = 32,
          LinkMask Links = all_links(M::joints), SensorKind Kind = Hexagon>
class SkinOf : public detail::SkinCore<M, T, Links, Capacity, Patches, Kind> {
  using Core = detail::SkinCore<M, T, Links, Capacity, Patches, Kind>;

 public:
  static_assert(Capacity > 0 && Patches > 0 && (detail::is_sound<Kind>() || true),
                "room for at least one cell");
  static_assert((Links & ~all_links(M::joints)) == 0, "the mask names a link that the model does not have");
  using typename Core::Settings;
  using typename Core::Wrenches;

  /// Throws `ConfigurationError` for more cells or patches than there is room for, a patch without cells or
  /// on a link that is not in `Links`, and for what `Patch`, `Skin` and `EventGate::counted` refuse.
  SKINCTL_COLD explicit SkinOf(const std::vector<ChannelPatch<Kind>>& placed, const Settings& settings = {})
      : Core(settings) {
    std::size_t count = 0;
    for (const auto& patch : placed) count += patch.cells.size();
    require(count > 0, "SkinOf: cells", 0, ">= 1");
    require(count <= Capacity, "SkinOf: cells", double(count),
            ("at most its capacity of " + std::to_string(Capacity)).c_str());
    require(placed.size() <= Patches, "SkinOf: patches", double(placed.size()),
            ("at most " + std::to_string(Patches)).c_str());
    this->tables_.reserve(count);
    detail::add_patches<Wrenches>(this->tables_, settings, placed);
  }
};

SKINCTL_END_NAMESPACE
