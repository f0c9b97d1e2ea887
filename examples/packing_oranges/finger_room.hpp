// Where the open fingers of a gripper come down beside an orange without standing on another one.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "skinctl/clearance/capsule.hpp"
#include "skinctl/frames/rotation.hpp"

namespace packing {

/// How a hand is to be turned over an orange, and how far its fingers are from the middle of the next one then.
struct FingerRoom {
  static constexpr double enough =
      0.062;         ///< an orange of 42 mm, half a finger, 8 mm for the detector's error [m]
  double turn = 0;   ///< about the vertical [rad]
  double room = -1;  ///< [m]
};

/// For fingers 110 mm apart along the y axis of a hand that stands as `straight`, with `p` between them, among the middles of
/// `others`: as it stands if there is room, else turned to where there is, or to where there is most. `turns`: false if the hand
/// is not to be turned.
[[nodiscard]] inline FingerRoom finger_room(const skinctl::Xyz<double>& p,
                                            const skinctl::Rotation<double>& straight,
                                            std::span<const skinctl::Xyz<double>> others, bool turns = true) {
  using skinctl::Xyz;
  FingerRoom best;
  for (const double turn : {0.0, M_PI / 4, -M_PI / 4, M_PI / 2}) {
    const Xyz<double> y = skinctl::exp_so3(Xyz<double>{0, 0, turn}) * straight * Xyz<double>{0, 1, 0};
    double room = 1;
    for (Xyz<double> other : others) {
      other.z = p.z;
      for (const double side : {-1.0, 1.0})
        room = std::min(room, skinctl::distance(
                                  other, skinctl::Capsule<>{p + side * 0.05 * y, p + side * 0.067 * y, 0.0}));
    }
    if (room > best.room) best = {turn, room};
    if (room >= FingerRoom::enough || !turns) break;
  }
  return best;
}

}  // namespace packing
