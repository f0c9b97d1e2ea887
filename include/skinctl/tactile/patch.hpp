// A patch of skin: cells that sit rigidly on one link.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/frames/wrench.hpp"

SKINCTL_BEGIN_NAMESPACE

/// How much a reading pushes, eq. (5). The force on a cell is `-(force * (f1 + f2 + f3) + proximity * p) z`:
/// along the inward normal, whatever the readings, because both gains are positive or 0.
struct Gains {
  double force = 10;     ///< w_f [N] per unit of the sum of the three force readings
  double proximity = 0;  ///< w_p [N] per unit of proximity
};

/// A cell on link `I`: its id in the samples, and where it is.
template <std::size_t I>
struct PlacedCell {
  std::uint32_t id = 0;
  Transform<Link<I>, Cell> X_LC;  ///< z is the outward normal
};

namespace detail {
SKINCTL_COLD inline void require_cell(const Xyz<double>& p, const Rotation<double>& R) {
  const double place = p.x + p.y + p.z;
  require(place - place == 0, "Patch: position of a cell", place, "finite m");
  const double error = rotation_error(R);
  require(error <= 1e-6, "Patch: |R'R - 1| of a cell", error, "<= 1e-6");
}
}  // namespace detail

/// `Cells` cells on link `I`, each known by an id, with the gains that they share. A configuration: built
/// once, then only read.
template <std::size_t I, std::size_t Cells>
class Patch {
 public:
  static_assert(Cells > 0, "a patch has at least one cell");
  static constexpr std::size_t link = I;
  static constexpr std::size_t cells = Cells;

  /// Throws `ConfigurationError` if there are not `Cells` of them, a pose is not finite, a normal is no unit
  /// vector, or a gain is negative or not finite.
  explicit Patch(std::vector<PlacedCell<I>> placed, const Gains& gains = {})
      : placed_(std::move(placed)), gains_(gains) {
    require(placed_.size() == Cells, "Patch: number of cells", double(placed_.size()),
            std::to_string(Cells).c_str());
    require(gains.force >= 0 && gains.force - gains.force == 0, "Patch: gain of force", gains.force,
            ">= 0 N");
    require(gains.proximity >= 0 && gains.proximity - gains.proximity == 0, "Patch: gain of proximity",
            gains.proximity, ">= 0 N");
    for (const auto& cell : placed_) detail::require_cell(cell.X_LC.origin(), cell.X_LC.axes());
  }

  [[nodiscard]] const std::vector<PlacedCell<I>>& placed() const noexcept { return placed_; }
  [[nodiscard]] const Gains& gains() const noexcept { return gains_; }

 private:
  std::vector<PlacedCell<I>> placed_;
  Gains gains_;
};

/// What one newton on the cell does to its link: `u = -[z ; p x z]`, eqs. (4) and (6). A cell carries no
/// moment about its own origin.
template <std::size_t I>
[[nodiscard]] inline Wrench<Link<I>, Link<I>, Link<I>> unit_wrench(
    const Transform<Link<I>, Cell>& X_LC) noexcept {
  const Xyz<double> z = X_LC.axis_z();
  return {-z, -cross(X_LC.origin(), z)};
}

SKINCTL_END_NAMESPACE
