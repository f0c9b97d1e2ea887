// SPDX-License-Identifier: BSD-3-Clause
// Covers of hexagonal cells for a link's surface, to simulate a skin.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The frame of a surface: cylinders and capsules are centred on its origin, along its z axis.
struct Surface : FrameTag {};

/// The hexagonal cell of TUM's skin, or a scaled copy of it: edge 14.0 mm, corners along its x axis, four
/// ports at (+-12, +-7) mm. The ports of two joined cells coincide (`p_j = p_i + R_i c_i - R_j c_j`), so that
/// their distance is 27.785 mm on a flat skin and a little less on a curved one; across y, where there is no
/// port, it is 28 mm.
struct HexagonalCell {
  double scale = 1;  ///< 1: size of TUM's cell

  static constexpr double edge = 0.014;                ///< edge of the hexagon at scale 1 [m]
  static constexpr double port_x = 0.012;              ///< distance of a port from the centre along x [m]
  static constexpr double port_y = 0.007;              ///< distance of a port from the centre along y [m]
  static constexpr double flat_pitch = 0.02778488798;  ///< flat skin's pitch [m], 2 sqrt(port_x^2 + port_y^2)
};

/// The lateral surface of a cylinder around z, from `-length/2` to `length/2` [m].
struct CylinderSurface {
  double radius;
  double length;
};
/// A cylinder's lateral surface with a half sphere at both ends; `length` is that of the cylinder between
/// them [m].
struct CapsuleSurface {
  double radius;
  double length;
};

namespace detail {

SKINCTL_COLD inline void require_cover(double radius, double length, const HexagonalCell& cell) {
  require(cell.scale >= 1e-4 && cell.scale <= 1e3, "cover: scale of a cell", cell.scale, "1e-4 to 1000");
  require(radius > 0 && radius <= 100, "cover: radius", radius, "> 0, <= 100 m");
  require(length > 0 && length <= 100, "cover: length", length, "> 0, <= 100 m");
}

/// Adds rings on the half sphere around the z axis on the side of `sign`, from the latitude `first` on. Cells
/// of two rings are not joined by ports, so they keep the wider of the cell's two distances.
SKINCTL_COLD inline void cover_half_sphere(double radius, double centre, double sign, double first,
                                           double apart, std::vector<Transform<Surface, Cell>>& cells) {
  if (apart > radius) return;
  const double step = 2 * std::asin(0.5 * apart / radius);
  const double pole = 0.5 * std::numbers::pi;
  for (double latitude = first; latitude <= pole + 1e-9; latitude += step) {
    const double ring = radius * std::cos(latitude);
    const std::size_t around =
        ring < 0.5 * apart
            ? 1
            : static_cast<std::size_t>(std::floor(std::numbers::pi / std::asin(0.5 * apart / ring) + 1e-9));
    const double tilt = around == 1 ? pole : latitude;
    if (around == 1 && latitude < pole - step) continue;
    for (std::size_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * double(k) / double(around);
      const double c = std::cos(tilt), s = std::sin(tilt);
      const Xyz<double> z{c * std::cos(angle), c * std::sin(angle), sign * s};
      const Xyz<double> up{-s * std::cos(angle), -s * std::sin(angle), sign * c};
      const Xyz<double> p{radius * z.x, radius * z.y, centre + radius * z.z};
      cells.push_back({{up, cross(z, up), z}, p});
    }
    if (around == 1) break;
  }
}

}  // namespace detail

/// Poses of the maximum number of whole cells on a surface, in a fixed order; normals (z) point outwards,
/// origins lie on the surface. Cells do not overlap or protrude beyond an end. On a cylinder rows along z
/// alternate by half a cell and are joined by their ports; a row that does not close leaves a seam. On a half
/// sphere cells lie in rings, at least 28 mm (times the scale) apart, and are not joined. Throws
/// `ConfigurationError` for a size outside of (0, 100] m and a scale outside of 1e-4 to 1000.
[[nodiscard]] SKINCTL_COLD inline std::vector<Transform<Surface, Cell>> full_cover(
    const CylinderSurface& surface, const HexagonalCell& cell = {}) {
  const auto [radius, length] = surface;
  detail::require_cover(radius, length, cell);
  const double x = cell.scale * HexagonalCell::port_x, y = cell.scale * HexagonalCell::port_y;
  std::vector<Transform<Surface, Cell>> cells;
  const double step = 2 * std::atan(y / radius);  // the ports of neighbours meet on the bisector
  const auto columns = static_cast<std::size_t>(std::floor(std::numbers::pi / step + 1e-9));
  const double room = length - 4 * y;  // a corner is two port heights from the centre
  if (columns < 3 || room < -1e-12) return cells;
  // A row that fits exactly is not lost to rounding.
  const std::size_t rows = static_cast<std::size_t>(std::floor(room / (2 * x) + 1e-9)) + 1;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const double angle = step * (2 * double(column) + double(row % 2));
      const double along = 2 * x * (double(row) - 0.5 * double(rows - 1));
      const Xyz<double> up{0.0, 0.0, 1.0}, z{std::cos(angle), std::sin(angle), 0.0};
      cells.push_back({{up, cross(z, up), z}, {radius * z.x, radius * z.y, along}});
    }
  return cells;
}
[[nodiscard]] SKINCTL_COLD inline std::vector<Transform<Surface, Cell>> full_cover(
    const CapsuleSurface& surface, const HexagonalCell& cell = {}) {
  const auto [radius, length] = surface;
  detail::require_cover(radius, length, cell);  // of an infinite radius the rings would never end
  const double y = cell.scale * HexagonalCell::port_y;
  // The rings begin at the edge of the cylinder's last row, which ends within its length.
  const double first = std::asin(std::min(1.0, 2 * y / radius));
  std::vector<Transform<Surface, Cell>> below;
  detail::cover_half_sphere(radius, -0.5 * length, -1.0, first, 4 * y, below);
  std::vector<Transform<Surface, Cell>> cells(below.rbegin(), below.rend());
  for (const auto& X : full_cover(CylinderSurface{radius, length}, cell)) cells.push_back(X);
  detail::cover_half_sphere(radius, 0.5 * length, 1.0, first, 4 * y, cells);
  return cells;
}

/// The largest cell, at most TUM's, of which `count` fit on the surface. Throws `ConfigurationError` if even
/// cells of a thousandth of that size do not fit.
template <class S>
[[nodiscard]] SKINCTL_COLD HexagonalCell largest_cell(const S& surface, std::size_t count) {
  const auto fits = [&](double scale) { return full_cover(surface, {scale}).size() >= count; };
  if (fits(1)) return {};
  double fitting = 1, too_large = 1;
  do {
    fitting /= 2;
    require(fitting > 1e-3, "cover: cells", double(count),
            "as many as find room at a thousandth of the size");
    if (!fits(fitting)) too_large = fitting;
  } while (too_large == fitting);
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (fitting + too_large);
    (fits(middle) ? fitting : too_large) = middle;
  }
  return {fitting};
}

namespace detail {
template <class S>
[[nodiscard]] SKINCTL_COLD std::vector<AnyCell> cover_any(const Transform<AnyLink, Surface>& X_LS,
                                                          const S& surface, std::size_t count,
                                                          std::uint32_t first_id) {
  const auto all = full_cover(surface, largest_cell(surface, count));
  const std::size_t skipped = (all.size() - count) / 2;
  std::vector<AnyCell> placed(count);
  for (std::size_t k = 0; k < count; ++k)
    placed[k] = {first_id + static_cast<std::uint32_t>(k), X_LS * all[skipped + k]};
  return placed;
}
}  // namespace detail

/// `count` cells on the surface at `X_LS` on link `Ix`, with ids from `first_id` on. Cells have TUM's size if
/// that many fit, else the largest size that does (`largest_cell`). If more cells fit, those nearest to the
/// middle of the cover's order are used, and the ends stay uncovered.
template <std::size_t Ix, class S>
[[nodiscard]] std::vector<PlacedCell<Ix>> cover(const Transform<Link<Ix>, Surface>& X_LS, const S& surface,
                                                std::size_t count, std::uint32_t first_id) {
  std::vector<PlacedCell<Ix>> placed;
  for (const auto& cell :
       detail::cover_any(X_LS.template renamed<detail::AnyLink, Surface>(), surface, count, first_id))
    placed.push_back({cell.id, cell.X_LC.template renamed<Link<Ix>, Cell>()});
  return placed;
}

SKINCTL_END_NAMESPACE
