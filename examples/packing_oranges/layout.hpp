// Where things are, in the World: two arms face each other across a box; each has its oranges to its right and a bin
// to its left. The second arm's places are those of the first, turned by half a circle.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>

#include "skinctl/core/triple.hpp"
#include "skinctl/frames/frame.hpp"
#include "skinctl/frames/transform.hpp"

namespace packing {

using namespace std::chrono_literals;

/// A rectangle on the table with walls around it [m].
struct Tray {
  double x = 0, y = 0, half_x = 0, half_y = 0, wall = 0;

  [[nodiscard]] constexpr bool holds(const skinctl::Xyz<double>& p) const noexcept {
    return p.x > x - half_x && p.x < x + half_x && p.y > y - half_y && p.y < y + half_y && p.z < wall + 0.03;
  }
};

inline constexpr std::size_t arms = 2;
/// Oranges of each arm that a world has room for at most, and where box and bins are emptied at once.
inline constexpr std::size_t slots = 12, slots_if_emptied = 4;
/// Places for oranges in the feed of an arm.
inline constexpr std::size_t feed_places = 3;

/// +1 for the first arm, -1 for the second.
[[nodiscard]] constexpr double side(std::size_t arm) noexcept {
  return arm == 0 ? 1 : -1;
}

inline constexpr Tray box_tray{0, 0, 0.17, 0.13, 0.08};
[[nodiscard]] constexpr Tray bin_tray(std::size_t arm) noexcept {
  return {-0.30 * side(arm), 0.42 * side(arm), 0.12, 0.12, 0.06};
}
/// Box and bins by their numbers, where they stand at first: 0 the box, `1 + arm` the bin of an arm.
inline constexpr std::size_t tray_count = 1 + arms;
using Trays = std::array<Tray, tray_count>;
inline constexpr Trays first_trays{box_tray, bin_tray(0), bin_tray(1)};
/// With a robot that drives there are two tables along y: oranges and bins on the first one, around the
/// World's origin, the box on the second one, whose middle is so far away [m].
inline constexpr double second_table = 1.6;
[[nodiscard]] constexpr Trays trays_at_first(bool drives, bool kitchen = false) noexcept {
  Trays out = first_trays;
  if (drives) out[0].y = second_table;
  if (!kitchen) return out;
  // A table on which tools are used has a plate where each bin stands, and no box: that one is far away.
  out[0].y = 3;
  for (std::size_t a = 0; a < arms; ++a) out[1 + a].wall = 0.015;
  return out;
}
/// Half sides of a table [m]; the arms stand on both sides of it.
inline constexpr double table_half_x = 0.5, table_half_y = 0.62;
/// Marks on the tables that are known, and that the detector sees: two on each.
inline constexpr std::array<skinctl::Xyz<double>, 4> table_marks{
    {{-0.45, 0.1, 0}, {0.45, -0.1, 0}, {-0.45, second_table + 0.25, 0}, {0.45, second_table - 0.25, 0}}};
/// Thickness of the bottom of a box or bin that can be moved: it takes along what it holds [m].
inline constexpr double tray_bottom = 0.003;
[[nodiscard]] constexpr Tray feed_tray(std::size_t arm) noexcept {
  return {-0.24 * side(arm), -0.40 * side(arm), 0.22, 0.09, 0.04};
}
[[nodiscard]] constexpr skinctl::Xyz<double> feed_place(std::size_t arm, std::size_t k) noexcept {
  return {(-0.24 + 0.15 * (static_cast<double>(k) - 1)) * side(arm), -0.40 * side(arm), 0};
}
/// Where an arm puts a full box, on the other arm's side of the table, as far as the shorter arm reaches with ease: a
/// person fetches it there.
[[nodiscard]] constexpr skinctl::Xyz<double> shelf_place(std::size_t arm) noexcept {
  return {0.22 * side(arm), 0, 0};
}
/// A box that is nearer to it than this is put there [m].
inline constexpr double put_within = 0.06;
/// As the first arm sees it from its side, seen from the side of an arm.
[[nodiscard]] constexpr skinctl::Xyz<double> seen_by(std::size_t arm,
                                                     const skinctl::Xyz<double>& p) noexcept {
  return {side(arm) * p.x, side(arm) * p.y, p.z};
}

/// Where a base stands on the floor.
struct Standing {
  double x = 0, y = 0, yaw = 0;  ///< [m], [rad]

  [[nodiscard]] skinctl::Transform<skinctl::World, skinctl::Base> pose() const {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return {{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}, {x, y, 0}};
  }
};

}  // namespace packing
