// Where in a box or bin a hand lets go of an orange, beside those that lie there or just above them.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "examples/packing_oranges/layout.hpp"

namespace packing {

/// What open fingers fill around the middle of what they let go.
struct OpenFingers {
  double along = 0.067, across = 0.012;  ///< half sides of their rectangle, along their way and across it [m]
  double below = 0.022;                  ///< they reach so far below the middle [m]
  double wall_along = 0.11,
         wall_across = 0.09;  ///< distances of the middle from walls: no limit slows the hand [m]
  double aside =
      0;  ///< of the middle of its places from that of the tray, away from the other arm's feed [m]
};

/// Least height of a hand over `p`, so that neither its open fingers, which move along the unit vector `e`, nor
/// what it holds meet oranges whose middles are `lying` [m]; `margin`: added to the distances beside them [m].
[[nodiscard]] inline double least_height(const skinctl::Xyz<double>& p, const skinctl::Xyz<double>& e,
                                         const OpenFingers& fingers,
                                         std::span<const skinctl::Xyz<double>> lying, double margin = 0) {
  constexpr double largest = 0.042, error = 0.006;  // radius of an orange; of where it is seen [m]
  const auto above = [](double reach, double d) {
    return d < reach ? std::sqrt(reach * reach - d * d) : -1.0;
  };
  double out = 0;
  for (const auto& o : lying) {
    const double x = o.x - p.x, y = o.y - p.y;
    const double u = std::abs(x * e.x + y * e.y), v = std::abs(y * e.x - x * e.y);
    const double beside = std::hypot(std::max(0.0, u - fingers.along), std::max(0.0, v - fingers.across));
    if (const double h = above(largest + error + margin, beside); h >= 0)
      out = std::max(out, o.z + h + fingers.below);
    if (const double h = above(2 * largest + margin, std::hypot(x, y)); h >= 0) out = std::max(out, o.z + h);
  }
  return out;
}

/// The place in a tray, from its middle, at which the hand of an arm gets lowest; of such, the one nearest to a
/// corner on its own side, as the middle has no room for fingers once the corners are full. z: the hand's
/// height, at least `lowest` [m].
[[nodiscard]] inline skinctl::Xyz<double> free_spot(std::size_t arm, const Tray& tray,
                                                    const skinctl::Xyz<double>& e, const OpenFingers& fingers,
                                                    std::span<const skinctl::Xyz<double>> lying,
                                                    double lowest) {
  constexpr int half = 3;
  const double along = std::abs(e.x), across = std::abs(e.y);
  const double width = tray.half_x - along * fingers.wall_along - across * fingers.wall_across;
  const double depth = tray.half_y - across * fingers.wall_along - along * fingers.wall_across;
  skinctl::Xyz<double> best{0, 0, lowest};
  double least = 1e9;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j) {
      const double x = i * std::max(0.0, width) / half,
                   y = j * std::max(0.0, depth) / half - side(arm) * fingers.aside;
      const double z = std::max(lowest, least_height({tray.x + x, tray.y + y, 0}, e, fingers, lying));
      const double cost = z - 0.02 * std::hypot(x, y) + 0.01 * side(arm) * x;
      if (cost < least) least = cost, best = {x, y, z};
    }
  return best;
}

}  // namespace packing
