// A patch of skin: cells fixed to one link.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/frames/wrench.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Gains of the readings, eq. (5). The force on a cell is `-(force * (f1 + f2 + f3) + proximity * p) z`:
/// along the inward normal for all readings, because both gains are positive or 0.
struct CellGains {
  double force = 10;     ///< w_f [N] per unit of the sum of the three force readings
  double proximity = 0;  ///< w_p [N] per unit of proximity
};

/// A cell on link `I`: its id in the samples, and its pose. For a pose measured in a link of a URDF see
/// `NamedCell` and `patch_on`.
template <std::size_t I>
struct PlacedCell {
  std::uint32_t id = 0;
  Transform<Link<I>, Cell> X_LC;  ///< z is the outward normal
};

namespace detail {
/// A cell whose link is not in its type, so that all patches share the code.
struct AnyLink : FrameTag {};
struct AnyCell {
  std::uint32_t id = 0;
  Transform<AnyLink, Cell> X_LC;
};

SKINCTL_COLD inline void require_patch(const std::vector<AnyCell>& placed, std::size_t cells,
                                       const CellGains& gains) {
  char wanted[24];
  std::snprintf(wanted, sizeof wanted, "%zu", cells);
  require(placed.size() == cells, "Patch: number of cells", double(placed.size()), wanted);
  require(gains.force >= 0 && gains.force - gains.force == 0, "Patch: gain of force", gains.force, ">= 0 N");
  require(gains.proximity >= 0 && gains.proximity - gains.proximity == 0, "Patch: gain of proximity",
          gains.proximity, ">= 0 N");
  for (const AnyCell& cell : placed) {
    const Xyz<double>& p = cell.X_LC.origin();
    const double place = p.x + p.y + p.z;
    require(place - place == 0, "Patch: position of a cell", place, "finite m");
    const double error = rotation_error(cell.X_LC.axes());
    require(error <= 1e-6, "Patch: |R'R - 1| of a cell", error, "<= 1e-6");
  }
}
}  // namespace detail

/// The cells of a patch, for inspection: a range of `PlacedCell<I>`.
template <std::size_t I>
class PlacedCells {
 public:
  explicit PlacedCells(const std::vector<detail::AnyCell>& cells) noexcept : cells_(cells) {}

  struct Iterator {
    const detail::AnyCell* at;
    PlacedCell<I> operator*() const noexcept { return {at->id, at->X_LC.template renamed<Link<I>, Cell>()}; }
    Iterator& operator++() noexcept { return ++at, *this; }
    friend bool operator==(const Iterator&, const Iterator&) noexcept = default;
  };
  [[nodiscard]] Iterator begin() const noexcept { return {cells_.data()}; }
  [[nodiscard]] Iterator end() const noexcept { return {cells_.data() + cells_.size()}; }
  [[nodiscard]] std::size_t size() const noexcept { return cells_.size(); }
  [[nodiscard]] PlacedCell<I> operator[](std::size_t i) const noexcept { return *Iterator{&cells_[i]}; }

 private:
  const std::vector<detail::AnyCell>& cells_;
};

/// `Cells` cells on link `I`, each with an id, and their common gains. Immutable.
template <std::size_t I, std::size_t Cells>
class Patch {
 public:
  static_assert(Cells > 0, "a patch has at least one cell");
  static constexpr std::size_t link = I;
  static constexpr std::size_t cells = Cells;

  /// Throws `ConfigurationError` if the number of cells is not `Cells`, a pose is not finite, a normal is no
  /// unit vector, or a gain is negative or not finite.
  explicit Patch(const std::vector<PlacedCell<I>>& placed, const CellGains& gains = {}) : gains_(gains) {
    placed_.reserve(placed.size());
    for (const auto& cell : placed)
      placed_.push_back({cell.id, cell.X_LC.template renamed<detail::AnyLink, Cell>()});
    detail::require_patch(placed_, Cells, gains);
  }
  /// The same for cells without a link in their type; the link is not checked.
  explicit Patch(std::vector<detail::AnyCell> placed, const CellGains& gains)
      : placed_(std::move(placed)), gains_(gains) {
    detail::require_patch(placed_, Cells, gains);
  }

  [[nodiscard]] PlacedCells<I> placed() const& noexcept { return PlacedCells<I>(placed_); }
  /// For a temporary patch: the cells themselves.
  [[nodiscard]] std::vector<PlacedCell<I>> placed() const&& {
    std::vector<PlacedCell<I>> copies;
    for (const auto& cell : PlacedCells<I>(placed_)) copies.push_back(cell);
    return copies;
  }
  [[nodiscard]] const std::vector<detail::AnyCell>& any() const noexcept { return placed_; }
  [[nodiscard]] const CellGains& gains() const noexcept { return gains_; }

 private:
  std::vector<detail::AnyCell> placed_;
  CellGains gains_;
};

/// The link's wrench for one newton on the cell: `u = -[z ; p x z]`, eqs. (4) and (6). A cell has no moment
/// about its own origin.
template <Frame L>
[[nodiscard]] inline Wrench<L, L, L> unit_wrench(const Transform<L, Cell>& X_LC) noexcept {
  const Xyz<double> z = X_LC.axis_z();
  return {-z, -cross(X_LC.origin(), z)};
}

SKINCTL_END_NAMESPACE
