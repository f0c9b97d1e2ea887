// Robots with prismatic joints, for tests of limits that add up joints of both kinds.
#pragma once

#include "skinctl/model/placement.hpp"

namespace skinctl::testing {

/// A chain of joints of these kinds.
template <JointKind... Kinds>
struct ChainOf {
  static constexpr std::size_t joints = sizeof...(Kinds);
  static constexpr auto parents = chain_parents<joints>();
  static constexpr std::array<JointKind, joints> kinds = {Kinds...};
};
constexpr JointKind slides = JointKind::prismatic, turns = JointKind::revolute;

/// Axes of which z is the next axis of the parent: x of it, then y of the frame before, then z.
inline const Rotation<double> next_axis{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};

/// A base on wheels, as two prismatic joints along x and y of the world and a yaw, and more joints behind it.
template <class Tree>
[[nodiscard]] std::array<PlacedLink, Tree::joints> on_wheels(double mass) {
  std::array<PlacedLink, Tree::joints> links;
  for (std::size_t i = 0; i < 3; ++i) links[i].R = next_axis;
  links[2].inertia = {mass, {0, 0, 0.2}, 3, 3, 4};
  return links;
}
template <class Tree>
[[nodiscard]] CalibratedModel<Tree> model_of(const std::array<PlacedLink, Tree::joints>& links) {
  return CalibratedModel<Tree>(canonical_links<Tree>(links).links);
}

/// Slides along y of the world, turns about its z, and slides along the x axis that turns.
using Cylindrical = ChainOf<slides, turns, slides>;
[[nodiscard]] inline CalibratedModel<Cylindrical> cylindrical() {
  std::array<PlacedLink, 3> links;
  links[0].R = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};  // z along y of the world, y along its x
  links[1].R = links[0].R.transpose();             // as the world
  links[2].R = next_axis;                          // z along x
  for (auto& link : links) link.inertia = {1, {0, 0, 0}, 0.01, 0.01, 0.01};
  return model_of<Cylindrical>(links);
}

}  // namespace skinctl::testing
