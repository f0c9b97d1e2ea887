// Where the open fingers of a gripper come down beside an orange without standing on another one.
#pragma once

#include <algorithm>
#include <array>
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

/// Ways on which the open fingers of a gripper stand around what they take, in the hand's axes.
inline constexpr std::array<skinctl::Xyz<double>, 2> two_fingers{{{0, 1, 0}, {0, -1, 0}}};

/// For fingers 55 mm from `p` on their `ways`, of a hand that stands as `straight`, among the middles of
/// `others`: as it stands if there is room, else turned to where there is, or to where there is most.
/// `turns`: false if the hand is not to be turned.
[[nodiscard]] inline FingerRoom finger_room(const skinctl::Xyz<double>& p,
                                            const skinctl::Rotation<double>& straight,
                                            std::span<const skinctl::Xyz<double>> others, bool turns = true,
                                            std::span<const skinctl::Xyz<double>> ways = two_fingers) {
  using skinctl::Xyz;
  FingerRoom best;
  for (const double turn : {0.0, M_PI / 4, -M_PI / 4, M_PI / 2}) {
    const skinctl::Rotation<double> R = skinctl::exp_so3(Xyz<double>{0, 0, turn}) * straight;
    double room = 1;
    for (Xyz<double> other : others) {
      other.z = p.z;
      for (const Xyz<double>& way : ways) {
        const Xyz<double> e = R * way;
        room = std::min(room, distance(other, skinctl::Capsule<>{p + 0.05 * e, p + 0.067 * e, 0.0}));
      }
    }
    if (room > best.room) best = {turn, room};
    if (room >= FingerRoom::enough || !turns) break;
  }
  return best;
}

}  // namespace packing
