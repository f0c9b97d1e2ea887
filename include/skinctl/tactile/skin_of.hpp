// SkinOf: a skin whose cells, patches and links are known at run time, each cell with gains and thresholds.
#pragma once

#include <optional>
#include <vector>

#include "skinctl/tactile/detail/skin_core.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The link of a cell where it is known at run time only.
using SomeLink = detail::AnyLink;

/// A cell of a `SkinPatch`: its id in the samples, its pose on the link, and what it has of its own.
struct SkinCell {
  std::uint32_t id = 0;
  Transform<SomeLink, Cell> X_LC;          ///< z is the outward normal
  std::optional<CellGains> gains{};        ///< none: those of its patch
  std::optional<EventGate<>> force{};      ///< on the sum of its forces; none: that of `SkinSettings`
  std::optional<EventGate<>> proximity{};  ///< none: that of `SkinSettings`
  bool masked = false;                     ///< it is no part of what feels, whatever it sends
};

/// Cells on link `link` with common gains. See `Patch`, which has its link and size in its type.
struct SkinPatch {
  std::size_t link = 0;
  CellGains gains{};
  std::vector<SkinCell> cells;
};

namespace detail {

/// Adds patches of a skin that is not known to the compiler to its tables.
template <class Wrenches, Real T>
SKINCTL_COLD void add_patches(SkinTables<T, true>& tables, const std::vector<SkinPatch>& patches) {
  constexpr std::size_t joints = Wrenches::model_type::joints;
  for (const SkinPatch& patch : patches) {
    require(patch.link < joints && ((Wrenches::links >> patch.link) & 1u) != 0, "SkinOf: link of a patch",
            double(patch.link), "a link of this skin's type");
    CellGains most = patch.gains;
    std::vector<AnyCell> placed;
    placed.reserve(patch.cells.size());
    for (const SkinCell& cell : patch.cells) {
      const CellGains own = cell.gains.value_or(patch.gains);
      require_patch({{cell.id, cell.X_LC}}, 1, own);
      most = {own.force > most.force ? own.force : most.force,
              own.proximity > most.proximity ? own.proximity : most.proximity};
      placed.push_back({cell.id, cell.X_LC});
    }
    require(!placed.empty(), "SkinOf: cells of a patch", 0, ">= 1");
    require_patch(placed, placed.size(), patch.gains);
    tables.add(placed, most, patch.link, Wrenches::slot(patch.link));
    for (const SkinCell& cell : patch.cells) {
      const CellGains own = cell.masked ? CellGains{0, 0} : cell.gains.value_or(patch.gains);
      tables.tune(cell.force.value_or(tables.settings.force),
                  cell.proximity.value_or(tables.settings.proximity),
                  most.force > 0 ? own.force / most.force : 1,
                  most.proximity > 0 ? own.proximity / most.proximity : 1);
    }
  }
}
inline std::size_t count_cells(const std::vector<SkinPatch>& patches) noexcept {
  std::size_t n = 0;
  for (const SkinPatch& patch : patches) n += patch.cells.size();
  return n;
}
inline std::size_t count_sums(const std::vector<SkinPatch>& patches) noexcept {
  std::size_t n = 0;
  for (const SkinPatch& patch : patches) n += sums_of(patch.cells.size());
  return n;
}

}  // namespace detail

/// A `Skin` of up to `Capacity` cells in up to `Patches` patches (each begun 8192 cells count as one), on
/// links of `Links`, all known at run time: from a file, say. What one cell reads is the same to the bit as in
/// a `Skin`, and a scene takes it in its place.
///
/// **Of each cell.** A threshold of its own, counted as in `EventGate::counted`; and gains of its own, as
/// shares of the largest gain in its patch, in steps of 2^-15. A share that is no whole step is off by at most
/// 2^-16, and a shared reading by half a count more. Where all cells of a patch have one gain nothing is
/// rounded. One that is masked, or has no gain, neither pushes nor counts as `usable`: it does not feel.
///
/// The memory is sized for `Capacity`, 17 bytes a cell, and 128 bytes a patch, whatever is used of it. A
/// robot's link without cells has a wrench of zero, and `nearest` on it is 1: nothing is known of it.
template <Topology M, Real T, std::size_t Capacity, std::size_t Patches = 32,
          LinkMask Links = all_links(M::joints)>
class SkinOf : public detail::SkinCore<M, T, Links, Capacity, Patches, true> {
  using Core = detail::SkinCore<M, T, Links, Capacity, Patches, true>;

 public:
  static_assert(Capacity > 0 && Patches > 0, "room for at least one cell");
  static_assert((Links & ~all_links(M::joints)) == 0, "the mask names a link that the model does not have");
  using typename Core::Wrenches;
  static constexpr std::size_t capacity = Capacity, most_patches = Patches;

  /// Throws `ConfigurationError` for more cells or patches than there is room for, a patch without cells or on
  /// a link that is not in `Links`, and for what `Patch`, `Skin` and `EventGate::counted` refuse.
  SKINCTL_COLD explicit SkinOf(const std::vector<SkinPatch>& patches, const SkinSettings& settings = {})
      : Core(settings, detail::count_cells(patches)) {
    require(detail::count_cells(patches) > 0, "SkinOf: cells", 0, ">= 1");
    require(detail::count_cells(patches) <= Capacity, "SkinOf: cells", double(detail::count_cells(patches)),
            ("at most its capacity of " + std::to_string(Capacity)).c_str());
    require(detail::count_sums(patches) <= Patches, "SkinOf: patches", double(detail::count_sums(patches)),
            ("at most " + std::to_string(Patches)).c_str());
    detail::add_patches<Wrenches>(this->tables_, patches);
  }
};

SKINCTL_END_NAMESPACE
