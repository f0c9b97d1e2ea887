// From joint frames as files and drawings give them to the links of a model.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/frames/rotation.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A link as a file describes it: its frame in the parent's frame at q = 0 (z on the joint's axis), and its
/// inertia in its own frame.
struct PlacedLink {
  Rotation<double> R;       ///< axes of the link in the parent at q = 0
  double p[3] = {0, 0, 0};  ///< origin of the link in the parent [m]
  LinkInertia inertia{};
};

/// Links of a model made from placed links. The model's frames stand on the same axes and origins as the
/// given ones, but are turned about z where that makes the placement of a first child a mere `Rx(alpha)`.
template <Topology Tree>
struct CanonicalLinks {
  std::array<LinkParameters<double>, Tree::joints> links;
  /// The given frame of link i is the model's frame turned by `-turn[i]` about z: `X_ModelGiven =
  /// Rz(-turn[i])`.
  std::array<double, Tree::joints> turn{};
};

namespace detail {

/// `R = Rz(gamma) Rx(alpha) Rz(beta)` with gamma in [-pi/2, pi/2]; right angles stay exact.
struct Zxz {
  Angle gamma, alpha;
  double beta;
};
inline Zxz decompose_zxz(const Rotation<double>& R) noexcept {
  Zxz out;
  const double s = std::hypot(R.z.x, R.z.y);
  if (s > 1e-15 && R.z.y < 0) {
    out.gamma = {-R.z.y / s, R.z.x / s};
    out.alpha = {R.z.z, s};
  } else if (s > 1e-15) {
    out.gamma = {R.z.y / s, -R.z.x / s};
    out.alpha = {R.z.z, -s};
  } else {
    out.alpha = {R.z.z < 0 ? -1.0 : 1.0, 0};
  }
  // x axis of the link seen after undoing gamma and alpha; robust also where alpha is tiny.
  const Triple x =
      turn_back_x(Turn{out.alpha.cos, out.alpha.sin}, turn_back_z(Turn{out.gamma.cos, out.gamma.sin}, R.x));
  out.beta = std::atan2(x.y, x.x);
  return out;
}

}  // namespace detail

/// Writes placed links, in the order of `Tree`, as links of a model. Exact up to rounding for every
/// placement, parallel and near-parallel axes included. Throws `ConfigurationError` for axes that are no
/// rotation (off by more than 1e-6).
template <Topology Tree>
[[nodiscard]] CanonicalLinks<Tree> canonical_links(const std::array<PlacedLink, Tree::joints>& placed) {
  constexpr std::size_t n = Tree::joints;
  CanonicalLinks<Tree> out;
  std::array<detail::Zxz, n> angles;
  std::array<JointPlacement, n> placements;
  for (std::size_t i = 0; i < n; ++i) {
    require(rotation_error(placed[i].R) <= 1e-6, "|R'R - 1| of a link's placement",
            rotation_error(placed[i].R), "<= 1e-6");
    angles[i] = detail::decompose_zxz(placed[i].R);
    for (std::size_t k = 0; k < 3; ++k) placements[i].p[k] = placed[i].p[k];
  }
  for (std::size_t i = 0; i < n; ++i) {
    Angle turn;  // of link i's frame, so that its first child has no gamma
    bool first = true;
    for (std::size_t c = i + 1; c < n; ++c) {
      if (Tree::parents[c] != static_cast<int>(i)) continue;
      if (first) {
        turn = angles[c].gamma;
        out.turn[i] = std::atan2(turn.sin, turn.cos);
        first = false;
      }
      const Angle g = angles[c].gamma;
      angles[c].gamma = {g.cos * turn.cos + g.sin * turn.sin, g.sin * turn.cos - g.cos * turn.sin};
      const double x = placements[c].p[0], y = placements[c].p[1];
      placements[c].p[0] = turn.cos * x + turn.sin * y;
      placements[c].p[1] = turn.cos * y - turn.sin * x;
      if (out.turn[i] == std::atan2(g.sin, g.cos)) angles[c].gamma = {};
    }
    placements[i].gamma = angles[i].gamma;
    placements[i].alpha = angles[i].alpha;
    const double beta = angles[i].beta + out.turn[i];
    if (Tree::kinds[i] == JointKind::revolute) {
      placements[i].offset = beta;
    } else if (beta != 0) {
      placements[i].beta = Angle::radians(beta);
    }
    out.links[i] = make_link(placements[i], turned_back_z(placed[i].inertia, turn));
  }
  return out;
}

SKINCTL_END_NAMESPACE
