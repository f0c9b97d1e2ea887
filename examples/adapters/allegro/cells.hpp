// The 16 tactile cells of a V5 Sense on the links of the hand, at approximate places.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "skinctl/robots/allegro.hpp"
#include "skinctl/tactile/skin_of.hpp"

namespace adapters::allegro {

/// Where a cell is. The maker publishes the cells' order (palm, then the index's two phalanges and tip; then
/// of middle, ring and thumb three phalanges and tip each) and no places: those here are the middle of each
/// pad, read off the links' lengths. Which phalanx of the index has no cell is a guess as well: the first.
struct CellPlace {
  int link = -1;  ///< of `skinctl::allegro::Tree`; -1: the palm, in the frame of the hand
  skinctl::Xyz<double>
      p{};          ///< in the frame of the maker's description of that link [m]: z along the finger,
  double tilt = 0;  ///< x out of the palm; the normal is x turned towards z by this [rad]
};

/// Cell k of the hand, in its order on the wire.
[[nodiscard]] inline CellPlace cell_place(std::size_t k) noexcept {
  if (k == 0) return {-1, {0.013, 0, -0.045}, 0};
  const std::size_t finger = k / 4, part = k % 4;
  const int proximal = static_cast<int>(4 * finger + 1);
  if (finger < 3) {
    if (part == 0) return {proximal, {0.014, 0, 0.027}, 0};
    if (part == 1) return {proximal + 1, {0.014, 0, 0.0192}, 0};
    if (part == 2) return {proximal + 2, {0.014, 0, 0.010}, 0};
    return {proximal + 2, {0.0104, 0, 0.0327}, 0.5236};
  }
  if (part == 0) return {proximal, {0.014, 0, 0.009}, 0};
  if (part == 1) return {proximal + 1, {0.014, 0, 0.0257}, 0};
  if (part == 2) return {proximal + 2, {0.014, 0, 0.020}, 0};
  return {proximal + 2, {0.0104, 0, 0.0483}, 0.5236};
}

/// Turns vectors in the axes of the maker's description of link `i` into those in which z is the joint's
/// axis: see `skinctl::allegro::finger_links`.
[[nodiscard]] inline skinctl::Rotation<double> makers_turn(std::size_t i,
                                                           skinctl::allegro::Side side) noexcept {
  using namespace skinctl::allegro::detail;
  const bool right = side == skinctl::allegro::Side::right;
  if (i == 12) return right ? minus_x_to_z : x_to_z;
  if (i == 13) return right ? one : minus_z_to_z;
  return i % 4 == 0 ? one : y_to_z;
}

/// Poses of the 16 cells in the frames of their links of `skinctl::allegro::hand(side)`, the palm's in the
/// frame of the hand; z is the outward normal.
using CellPose = skinctl::Transform<skinctl::SomeLink, skinctl::Cell>;
[[nodiscard]] inline std::array<CellPose, 16> cell_poses(skinctl::allegro::Side side) {
  using skinctl::Rotation, skinctl::turn_back;
  std::array<CellPose, 16> out;
  for (std::size_t k = 0; k < 16; ++k) {
    const CellPlace place = cell_place(k);
    const double s = std::sin(place.tilt), c = std::cos(place.tilt);
    const Rotation<double> R_UC{{-s, 0, c}, {0, -1, 0}, {c, 0, s}};  // x, y, z of the cell
    Rotation<double> R_LU;
    if (place.link >= 0) {
      const auto i = static_cast<std::size_t>(place.link);
      const auto canonical =
          skinctl::canonical_links<skinctl::Chain<4>>(skinctl::allegro::finger_links(i / 4, side));
      const double turn = -canonical.turn[i % 4];
      const Rotation<double> about_z{{std::cos(turn), std::sin(turn), 0},
                                     {-std::sin(turn), std::cos(turn), 0}};
      R_LU = about_z * makers_turn(i, side).transpose();
    }
    out[k] = CellPose(R_LU * R_UC, turn_back(R_LU.transpose(), place.p));
  }
  return out;
}

/// The cells as patches of a model that has the hand's link i as its link `first + i`. The palm's cell moves
/// with link `palm`; without such a link (-1: a hand that is fixed to the world) it is left out: its force
/// moves nothing.
/// @param gain  [N] per unit of the sum of the three (equal) readings. Uncalibrated.
[[nodiscard]] inline std::vector<skinctl::SkinPatch> skin_patches(skinctl::allegro::Side side, double gain,
                                                                  std::size_t first = 0, int palm = -1) {
  const auto poses = cell_poses(side);
  std::vector<skinctl::SkinPatch> patches;
  for (std::size_t k = 0; k < 16; ++k) {
    const int link = cell_place(k).link;
    if (link < 0 && palm < 0) continue;
    const std::size_t at = link < 0 ? static_cast<std::size_t>(palm) : first + static_cast<std::size_t>(link);
    if (patches.empty() || patches.back().link != at)
      patches.push_back({.link = at, .gains = {.force = gain, .proximity = 0}, .cells = {}});
    patches.back().cells.push_back({.id = static_cast<std::uint32_t>(k), .X_LC = poses[k]});
  }
  return patches;
}

}  // namespace adapters::allegro
