// runs long: covers of random cells
#include "skinctl/tactile/cover.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Cells = std::vector<Transform<Surface, Cell>>;

/// Places of the four ports and the six corners of a cell.
std::vector<Xyz<double>> ports(const Transform<Surface, Cell>& X, double scale) {
  std::vector<Xyz<double>> out;
  for (const double x : {0.012, -0.012})
    for (const double y : {0.007, -0.007})
      out.push_back(X.origin() + X.axes() * Xyz<double>{scale * x, scale * y, 0});
  return out;
}
std::vector<Xyz<double>> corners(const Transform<Surface, Cell>& X, double scale) {
  std::vector<Xyz<double>> out;
  for (int k = 0; k < 6; ++k) {
    const double a = k * std::numbers::pi / 3;
    out.push_back(X.origin() + 0.014 * scale * (X.axes() * Xyz<double>{std::cos(a), std::sin(a), 0}));
  }
  return out;
}
/// How many pairs of ports of two cells are at the same place.
int joints(const Transform<Surface, Cell>& A, const Transform<Surface, Cell>& B, double scale) {
  int n = 0;
  for (const auto& a : ports(A, scale))
    for (const auto& b : ports(B, scale)) n += norm(a - b) < 1e-12;
  return n;
}
double bend(const Transform<Surface, Cell>& A, const Transform<Surface, Cell>& B) {
  return std::acos(std::clamp(dot(A.axis_z(), B.axis_z()), -1.0, 1.0));
}

/// Neighbours are at the pitch, or a little nearer where the skin is bent; no two cells overlap. Returns how
/// many pairs are joined by their ports.
int check_distances(const Cells& cells, double scale) {
  int joined = 0;
  double nearest = 1;
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t j = i + 1; j < cells.size(); ++j) {
      const double distance = norm(cells[i].origin() - cells[j].origin());
      const double pitch = scale * HexagonalCell::flat_pitch;
      // Farther apart than twice the distance of a port, no two ports meet.
      const int n = distance > 1.01 * pitch ? 0 : joints(cells[i], cells[j], scale);
      if (n > 0) {
        CHECK(n == 1);
        ++joined;
        CHECK(distance <= pitch * (1 + 1e-9));
        CHECK(distance >= pitch * std::cos(bend(cells[i], cells[j]) / 2) * (1 - 1e-9));
        if (bend(cells[i], cells[j]) < 1e-12) CHECK(distance == doctest::Approx(pitch).epsilon(1e-9));
      }
      if (bend(cells[i], cells[j]) < 1) nearest = std::min(nearest, distance);
    }
  // Across flat sides hexagons of edge a are sqrt(3) a wide: nearer centres would overlap.
  if (cells.size() > 1) CHECK(nearest >= scale * 0.014 * std::numbers::sqrt3 * 0.93);
  return joined;
}

}  // namespace

TEST_CASE("cover: cells on a cylinder stand on it, look outwards, are joined by their ports and stay on it") {
  for (const double radius : {0.03, 0.05, 0.06, 0.3})
    for (const double length : {0.028, 0.1, 0.345})
      for (const double scale : {1.0, 0.4}) {
        CAPTURE(radius);
        CAPTURE(length);
        CAPTURE(scale);
        const Cells cells = full_cover(CylinderSurface{radius, length}, {scale});
        REQUIRE(!cells.empty());
        for (const auto& X : cells) {
          const Xyz<double> p = X.origin(), z = X.axis_z();
          CHECK(rotation_error(X.axes()) <= 1e-15);
          CHECK(std::hypot(p.x, p.y) == doctest::Approx(radius).epsilon(1e-12));
          CHECK(norm(z - Xyz<double>{p.x / radius, p.y / radius, 0}) <= 1e-12);
          for (const auto& corner : corners(X, scale)) CHECK(std::abs(corner.z) <= length / 2 + 1e-12);
        }
        const int joined = check_distances(cells, scale);
        // Rows and columns as they find room; all rows have the same number.
        const double half_step = 2 * std::atan(scale * 0.007 / radius);
        const auto columns = static_cast<std::size_t>(std::numbers::pi / half_step);
        const auto rows = static_cast<std::size_t>((length - 0.028 * scale) / (0.024 * scale) + 1 + 1e-9);
        CHECK(cells.size() == rows * columns);
        // Between two rows every cell has two joints, but for the seam.
        CHECK(joined >= int((rows - 1) * (2 * columns - 1)));
        CHECK(joined <= int((rows - 1) * 2 * columns));
      }
}

TEST_CASE("cover: cells on a capsule cover its ends as well, apart from each other") {
  const CapsuleSurface capsule{0.06, 0.2};
  for (const double scale : {1.0, 0.5, 0.25}) {
    const Cells cells = full_cover(capsule, {scale});
    std::size_t side = 0, top = 0, bottom = 0;
    double highest = 0;
    for (const auto& X : cells) {
      const Xyz<double> p = X.origin(), z = X.axis_z();
      CHECK(rotation_error(X.axes()) <= 1e-15);
      const double centre = std::clamp(p.z, -0.1, 0.1);
      CHECK(norm(p - Xyz<double>{0, 0, centre} - 0.06 * z) <= 1e-12);
      (std::abs(p.z) <= 0.1 ? side : p.z > 0 ? top : bottom) += 1;
      highest = std::max(highest, p.z);
    }
    CHECK(side == full_cover(CylinderSurface{0.06, 0.2}, {scale}).size());
    CHECK(top == bottom);
    CHECK(top >= 7);
    CHECK(highest >= 0.16 - 0.02 * scale);
    check_distances(cells, scale);
  }
}

TEST_CASE("cover: exactly as many cells as asked for, the largest that find room") {
  const CylinderSurface tube{0.05, 0.3};
  const std::size_t room = full_cover(tube).size();
  const auto at = Transform<Link<1>, Surface>::rotation_y(0.7);
  for (const std::size_t count :
       {std::size_t(1), std::size_t(17), room - 1, room, room + 1, 3 * room, 40 * room}) {
    CAPTURE(count);
    const auto placed = cover<1>(at, tube, count, 40);
    REQUIRE(placed.size() == count);
    for (std::size_t k = 0; k < count; ++k) CHECK(placed[k].id == 40 + k);
    const HexagonalCell cell = largest_cell(tube, count);
    CHECK((cell.scale == 1) == (count <= room));
    CHECK(full_cover(tube, cell).size() >= count);
    if (count > room) CHECK(full_cover(tube, {cell.scale * 1.0001}).size() < count);
  }
  // The surface's pose is applied.
  const auto X_SC = at.inverse() * cover<1>(at, tube, room, 0)[5].X_LC;
  CHECK(norm(X_SC.origin() - full_cover(tube)[5].origin()) <= 1e-15);
}

TEST_CASE("cover: what cannot be covered is refused") {
  CHECK_THROWS_AS((void)full_cover(CylinderSurface{-0.1, 0.3}), ConfigurationError);
  CHECK_THROWS_AS((void)full_cover(CylinderSurface{0.1, std::nan("")}), ConfigurationError);
  CHECK_THROWS_AS((void)full_cover(CapsuleSurface{0.1, 0}), ConfigurationError);
  CHECK_THROWS_AS((void)largest_cell(CylinderSurface{1e-6, 1e-6}, 10), ConfigurationError);
}

TEST_CASE("HexagonalCell: the flat pitch is twice the distance of a port") {
  CHECK(HexagonalCell::flat_pitch == doctest::Approx(2 * std::hypot(0.012, 0.007)).epsilon(1e-9));
  CHECK(HexagonalCell::flat_pitch == doctest::Approx(0.027785).epsilon(1e-4));
}
