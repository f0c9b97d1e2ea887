// SPDX-License-Identifier: BSD-3-Clause
// A patch of skin: cells fixed to one link.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/frames/wrench.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Gains of the readings, eq. (5). The force on a cell is `-(force * (f1 + f2 + f3) + proximity * p) z`:
/// along the inward normal for all readings, because both gains are positive or 0.
struct CellGains {
  double force = 10;     ///< gain w_f [N] per unit of the sum of the three force readings
  double proximity = 0;  ///< gain w_p [N] per unit of the proximity reading
};

/// Gains of the channels of a kind of sensor, in its order [N per unit of the channel's amount].
template <SensorKind Kind>
struct ChannelGains {
  std::array<double, KindTable<Kind>::pushing> channel = [] {
    std::array<double, KindTable<Kind>::pushing> ones{};
    for (std::size_t c = 0; c < ones.size(); ++c) ones[c] = KindTable<Kind>::is_seen(c) ? 0 : 1;
    return ones;
  }();
};
template <SensorKind Kind>
using GainsOf = std::conditional_t<std::is_same_v<Kind, Hexagon>, CellGains, ChannelGains<Kind>>;

/// A cell on link `Ix`: its id in the samples, and its pose. For a pose measured in a link of a URDF see
/// `NamedCell` and `patch_on`.
template <std::size_t Ix>
struct PlacedCell {
  std::uint32_t id = 0;
  Transform<Link<Ix>, Cell> X_LC;  ///< pose of the cell on the link; z is the outward normal
};

namespace detail {
/// The frame of a link that is not in the type, so that all patches share the code.
struct AnyLink : FrameTag {};
struct AnyCell {
  std::uint32_t id = 0;
  Transform<AnyLink, Cell> X_LC;
};

/// Gains in the order of the channels.
[[nodiscard]] inline std::array<double, 2> gain_list(const CellGains& g) noexcept {
  return {g.force, g.proximity};
}
template <SensorKind Kind>
[[nodiscard]] const auto& gain_list(const ChannelGains<Kind>& g) noexcept {
  return g.channel;
}
template <class Kind>
SKINCTL_COLD void require_gains(const GainsOf<Kind>& gains) {
  const auto list = gain_list(gains);
  for (std::size_t c = 0; c < list.size(); ++c)
    require(list[c] >= 0 && list[c] <= 1e4, ("Patch: gain of " + std::string(Kind::channels[c].name)).c_str(),
            list[c], "0 to 1e4 N");
}

SKINCTL_COLD inline void require_cells(const std::vector<AnyCell>& placed, std::size_t cells) {
  char wanted[24];
  std::snprintf(wanted, sizeof wanted, "%zu", cells);
  require(placed.size() == cells, "Patch: number of cells", double(placed.size()), wanted);
  for (const AnyCell& cell : placed) {
    const Xyz<double>& p = cell.X_LC.origin();
    const double place = p.x + p.y + p.z;
    require(place - place == 0, "Patch: position of a cell", place, "finite m");
    const double distance = norm(p);
    require(distance <= 10, "Patch: distance of a cell from its link's origin", distance, "<= 10 m");
    const double error = rotation_error(cell.X_LC.axes());
    require(error <= 1e-6, "Patch: |R'R - 1| of a cell", error, "<= 1e-6");
  }
}
}  // namespace detail

/// `Cells` cells of a kind on link `Ix`, each with an id, and their common gains. Immutable.
template <std::size_t Ix, std::size_t Cells, SensorKind Kind = Hexagon>
class Patch {
 public:
  using kind = Kind;
  using Gains = GainsOf<Kind>;
  static_assert(Cells > 0 && (detail::is_sound<Kind>() || true), "a patch has at least one cell");
  static constexpr std::size_t link = Ix;
  static constexpr std::size_t cells = Cells;

  /// Throws `ConfigurationError` if the number of cells is not `Cells`, a cell's axes are no rotation, its
  /// origin is not finite or more than 10 m from the link's, or a gain is outside of 0 to 1e4 N.
  explicit Patch(const std::vector<PlacedCell<Ix>>& placed, const Gains& gains = {}) : gains_(gains) {
    placed_.reserve(placed.size());
    for (const auto& cell : placed)
      placed_.push_back({cell.id, cell.X_LC.template renamed<detail::AnyLink, Cell>()});
    detail::require_cells(placed_, Cells);
    detail::require_gains<Kind>(gains);
  }
  /// Takes cells without a link in their type; the link is not checked. Throws as the other constructor.
  template <std::same_as<detail::AnyCell> C>  // of no other type, so that braces are cells of this link
  explicit Patch(std::vector<C> placed, const Gains& gains) : placed_(std::move(placed)), gains_(gains) {
    detail::require_cells(placed_, Cells);
    detail::require_gains<Kind>(gains);
  }

  /// The cells with their link, for inspection.
  [[nodiscard]] SKINCTL_COLD std::vector<PlacedCell<Ix>> placed() const {
    std::vector<PlacedCell<Ix>> out;
    for (const auto& cell : placed_) out.push_back({cell.id, cell.X_LC.template renamed<Link<Ix>, Cell>()});
    return out;
  }
  [[nodiscard]] const std::vector<detail::AnyCell>& any() const noexcept { return placed_; }
  [[nodiscard]] const Gains& gains() const noexcept { return gains_; }

 private:
  std::vector<detail::AnyCell> placed_;
  Gains gains_;
};

/// The wrench on the link, about its origin along its axes, for one newton on the cell: `u = -[z ; p x z]`,
/// eqs. (4) and (6). A cell has no moment about its own origin.
template <Frame L>
[[nodiscard]] inline Wrench<L, L, L> unit_wrench(const Transform<L, Cell>& X_LC) noexcept {
  const Xyz<double> z = X_LC.axis_z();
  return {-z, -cross(X_LC.origin(), z)};
}

SKINCTL_END_NAMESPACE
