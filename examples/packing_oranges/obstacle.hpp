// Something that moves through the arms' room, and the skin that sees it.
#pragma once

#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/clearance/capsule.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/tactile/cell_place.hpp"
#include "skinctl/tactile/cover.hpp"

namespace packing {

/// How a cell sees: readings of `1 - distance/range`.
inline constexpr double sight_range = 0.2, sight_cone = 25;  ///< [m], half angle [degrees]

/// Cells all around capsules of link `I`, ends included, `size` times as long as TUM's; ids from `first` on.
template <std::size_t I>
[[nodiscard]] std::vector<skinctl::PlacedCell<I>> cells_around(
    std::initializer_list<skinctl::Capsule<>> shapes, std::uint32_t first, double size = 1.6) {
  using namespace skinctl;
  std::vector<PlacedCell<I>> out;
  for (const Capsule<>& s : shapes) {
    const Xyz<double> way = s.to - s.from;
    const double length = norm(way);
    const Xyz<double> z = (1 / length) * way,
                      a = std::abs(z.x) < 0.5 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
    const Xyz<double> across = cross(z, a), y = (1 / norm(across)) * across;
    const Transform<Link<I>, Surface> X_LS({cross(y, z), y, z}, 0.5 * (s.from + s.to));
    for (const auto& X_SC : full_cover(CapsuleSurface{s.radius, length}, {size}))
      out.push_back({first++, (X_LS * X_SC).template renamed<Link<I>, Cell>()});
  }
  return out;
}

/// What cells read of capsules: the nearest point that thirteen rays within the cone meet, with noise. They do not see
/// their own arm and the table: `OwnView` takes these out, and has a test of its own.
class Eyes {
 public:
  Eyes(std::vector<skinctl::CellPlace> cells, std::uint64_t seed);
  [[nodiscard]] const std::vector<skinctl::CellPlace>& cells() const { return cells_; }
  /// With the links there, in the world. Valid until the next call.
  std::span<const double> look(std::span<const skinctl::Transform<skinctl::World, skinctl::Tool>> links,
                               std::span<const skinctl::Capsule<>> around);

 private:
  std::vector<skinctl::CellPlace> cells_;
  std::vector<skinctl::Xyz<double>> rays_;
  std::vector<double> readings_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// A ball that is carried straight through the room of both arms, 0.3 m above the table or higher, again and again, each
/// time another way.
class Passer {
 public:
  Passer(double speed, std::uint64_t seed) : speed_(speed), random_(seed) {}
  /// Where it is after `dt` more seconds; a radius of 0: nowhere. It does not begin near anything in `near`, nor does it go
  /// for their feet (`stands` from the middle), which cannot give way.
  const skinctl::Capsule<>& step(double dt, double stands, std::span<const skinctl::Capsule<>> near);
  [[nodiscard]] int passes() const { return passes_; }

 private:
  void begin(double stands, std::span<const skinctl::Capsule<>> near);
  double speed_;
  std::mt19937_64 random_;
  skinctl::Xyz<double> from_{0, 0, 0}, along_{0, 0, 0};
  skinctl::Capsule<> at_{{0, 0, 0}, {0, 0, 0}, 0};
  double radius_ = 0, way_ = 0, rests_ = 2;
  int passes_ = 0;
};

}  // namespace packing
