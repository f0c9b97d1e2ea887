// The grids behind cover.hpp: rows of hexagons on planes, cylinders and half spheres. The offset between
// joined cells is (2 x, 2 y), where (x, y) is the position of a cell's port.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Number of places at distance `spacing` within `room`, including both ends; a row that fits exactly is not
/// lost to rounding.
inline std::size_t places(double room, double spacing) {
  return room < -1e-12 ? 0 : static_cast<std::size_t>(std::floor(room / spacing + 1e-9)) + 1;
}

/// Half the extent of the hexagon along its x axis (corner) and along its y axis (flat side). The ports of
/// TUM's cells are at (12, 7) mm and the edge is 14 mm: twice the port's y.
inline double corner(double port_y) {
  return 2 * port_y;
}
inline double flat(double port_y) {
  return std::numbers::sqrt3 * port_y;
}

inline void require_size(double size, const char* name) {
  require(size > 0 && size <= 100, name, size, "> 0, <= 100 m");
}

/// A cell at `p` with outward normal `z` and x axis `x`, perpendicular unit vectors.
template <class Surface>
Transform<Surface, Cell> cell_at(const Xyz<double>& p, const Xyz<double>& x, const Xyz<double>& z) {
  return {{x, cross(z, x), z}, p};
}

template <class Surface>
SKINCTL_COLD std::vector<Transform<Surface, Cell>> cover_cylinder(double radius, double length, double x,
                                                                  double y) {
  require_size(radius, "cover: radius");
  require_size(length, "cover: length");
  const double step = 2 * std::atan(y / radius);  // the ports of neighbours meet on the bisector
  const std::size_t rows = places(length - 2 * corner(y), 2 * x);
  const std::size_t columns = static_cast<std::size_t>(std::floor(std::numbers::pi / step + 1e-9));
  std::vector<Transform<Surface, Cell>> cells;
  if (columns < 3) return cells;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const double angle = step * (2 * double(column) + double(row % 2));
      const double along = 2 * x * (double(row) - 0.5 * double(rows - 1));
      const Xyz<double> z{std::cos(angle), std::sin(angle), 0.0};
      cells.push_back(cell_at<Surface>({radius * z.x, radius * z.y, along}, {0.0, 0.0, 1.0}, z));
    }
  return cells;
}

/// Rings on the half sphere around the z axis on the side of `sign`, from `first` above the equator on.
template <class Surface>
void cover_half_sphere(double radius, double centre, double sign, double first, double y,
                       std::vector<Transform<Surface, Cell>>& cells) {
  const double apart = 4 * y;  // no joints here: the wider of the two distances
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
      cells.push_back(cell_at<Surface>({radius * z.x, radius * z.y, centre + radius * z.z}, up, z));
    }
    if (around == 1) break;
  }
}

template <class Surface>
SKINCTL_COLD std::vector<Transform<Surface, Cell>> cover_capsule(double radius, double length, double x,
                                                                 double y) {
  require_size(radius, "cover: radius");  // of an infinite one the rings below would never end
  require_size(length, "cover: length");
  std::vector<Transform<Surface, Cell>> below, cells;
  // The rings begin at the edge of the cylinder's last row, which ends within its length.
  const double first = std::asin(std::min(1.0, corner(y) / radius));
  cover_half_sphere(radius, -0.5 * length, -1.0, first, y, below);
  for (std::size_t k = below.size(); k-- > 0;) cells.push_back(below[k]);
  for (const auto& cell : cover_cylinder<Surface>(radius, length, x, y)) cells.push_back(cell);
  cover_half_sphere(radius, 0.5 * length, 1.0, first, y, cells);
  return cells;
}

/// A plane of `a` by `b` (along the cells' x and y), centred at `centre`.
template <class Surface>
void cover_plane(double a, double b, const Xyz<double>& centre, const Xyz<double>& along_a,
                 const Xyz<double>& normal, double x, double y,
                 std::vector<Transform<Surface, Cell>>& cells) {
  const Xyz<double> along_b = cross(normal, along_a);
  const std::size_t rows = places(a - 2 * corner(y), 2 * x);
  const std::size_t even = places(b - 2 * flat(y), 4 * y);
  const std::size_t odd = places(b - 2 * flat(y) - 2 * y, 4 * y);
  const double width = 4 * y * double(even > 0 ? even - 1 : 0) + (even == odd && rows > 1 ? 2 * y : 0.0);
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < (row % 2 ? odd : even); ++column) {
      const double u = 2 * x * (double(row) - 0.5 * double(rows - 1));
      const double v = 4 * y * double(column) + (row % 2 ? 2 * y : 0.0) - 0.5 * width;
      cells.push_back(cell_at<Surface>(centre + u * along_a + v * along_b, along_a, normal));
    }
}

template <class Surface>
SKINCTL_COLD std::vector<Transform<Surface, Cell>> cover_box(double size_x, double size_y, double size_z,
                                                             double x, double y) {
  require_size(size_x, "cover: edge along x");
  require_size(size_y, "cover: edge along y");
  require_size(size_z, "cover: edge along z");
  const Xyz<double> ex{1.0, 0.0, 0.0}, ey{0.0, 1.0, 0.0}, ez{0.0, 0.0, 1.0};
  std::vector<Transform<Surface, Cell>> cells;
  const double hx = 0.5 * size_x, hy = 0.5 * size_y, hz = 0.5 * size_z;
  cover_plane(size_x, size_y, -hz * ez, ex, -ez, x, y, cells);
  cover_plane(size_z, size_x, -hy * ey, ez, -ey, x, y, cells);
  cover_plane(size_z, size_y, hx * ex, ez, ex, x, y, cells);
  cover_plane(size_z, size_x, hy * ey, ez, ey, x, y, cells);
  cover_plane(size_z, size_y, -hx * ex, ez, -ex, x, y, cells);
  cover_plane(size_x, size_y, hz * ez, ex, ez, x, y, cells);
  return cells;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
