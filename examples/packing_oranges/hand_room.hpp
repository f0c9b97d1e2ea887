// Where an arm can hold its hand so that it points down.
#pragma once

#include <algorithm>

#include "examples/packing_oranges/layout.hpp"

namespace packing {

/// The point between the fingers, beyond the flange [m].
inline constexpr double reach_of_gripper = 0.16;

/// The room of a hand that points down, of an arm of Universal Robots.
struct HandRoom {
  double stands;     ///< from the middle of the box to the arm's base [m]
  double shoulder;   ///< height of the shoulder over the table [m]
  double stretched;  ///< upper arm and forearm [m]
  double beside;     ///< from their plane to the wrist [m]
  double flange;     ///< from the wrist, where it is as high as the forearm's end, down to the flange [m]

  /// Whether the hand of the first arm comes there with its elbow bent: 3 % are left of what the arm is long.
  [[nodiscard]] constexpr bool reaches(const skinctl::Xyz<double>& p) const noexcept {
    const double x = p.x + stands, up = p.z + reach_of_gripper + flange - shoulder;
    const double far = std::max(0.0, x * x + p.y * p.y - beside * beside);
    constexpr double bent = 0.97, nearest = 0.25;
    return far + up * up <= bent * bent * stretched * stretched && x * x + p.y * p.y >= nearest * nearest;
  }
};

}  // namespace packing
