// SPDX-License-Identifier: BSD-3-Clause
// Conversion of joint frames from files and drawings to the links of a model.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/frames/rotation.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A link as described in a file: its frame in the parent's frame at q = 0 (z on the joint's axis), and its
/// inertia in its own frame.
struct PlacedLink {
  Rotation<double> R;       ///< axes of the link in the parent at q = 0
  double p[3] = {0, 0, 0};  ///< origin of the link in the parent [m]
  LinkInertia inertia{};
};

/// Links of a model made from placed links. The model's frames have the same z axes and origins as the given
/// ones, but are rotated about z where that reduces the placement of a first child to `Rx(alpha)`.
template <Topology Tree>
struct TurnedLinks {
  std::array<LinkParameters<double>, Tree::joints> links;
  /// The given frame of link i is the model's frame rotated by `-turn[i]` about z:
  /// `X_ModelGiven = Rz(-turn[i])`.
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
  // x axis of the link after gamma and alpha are undone; robust also where alpha is tiny.
  const Triple x =
      turn_back_x(Turn{out.alpha.cos, out.alpha.sin}, turn_back_z(Turn{out.gamma.cos, out.gamma.sin}, R.x));
  out.beta = std::atan2(x.y, x.x);
  return out;
}

}  // namespace detail

/// The inertia of a body given in a frame with pose `R`, `p`, expressed in the outer frame: a payload on a
/// flange, a tip on a finger.
inline LinkInertia seen_from(const Rotation<double>& R, const Xyz<double>& p,
                             const LinkInertia& in) noexcept {
  const Rotation<double> rows = R.transpose();  // rows.x is the outer x axis in inner axes
  const auto Ix = [&](const Xyz<double>& v) {
    return Xyz<double>{in.xx * v.x + in.xy * v.y + in.xz * v.z, in.xy * v.x + in.yy * v.y + in.yz * v.z,
                       in.xz * v.x + in.yz * v.y + in.zz * v.z};
  };
  const Xyz<double> c = p + R * Xyz<double>{in.c[0], in.c[1], in.c[2]};
  return {in.mass,
          {c.x, c.y, c.z},
          dot(rows.x, Ix(rows.x)),
          dot(rows.y, Ix(rows.y)),
          dot(rows.z, Ix(rows.z)),
          dot(rows.x, Ix(rows.y)),
          dot(rows.x, Ix(rows.z)),
          dot(rows.y, Ix(rows.z))};
}

/// The link of a model whose parent's frame now has the pose `R`, `p` in another frame. The link's own frame,
/// its inertia and its motion do not change.
inline LinkParameters<double> placed_at(const LinkParameters<double>& link, JointKind kind,
                                        const Rotation<double>& R, const Xyz<double>& p) noexcept {
  using P = LinkParameter;
  LinkParameters<double> out = link;
  const double g = link[P::sin_gamma], h = link[P::cos_gamma], s = link[P::sin_alpha], c = link[P::cos_alpha];
  const auto zxz =
      detail::decompose_zxz(R * Rotation<double>{{h, g, 0}, {-g * c, h * c, s}, {g * s, -h * s, c}});
  const Xyz<double> origin = p + R * Xyz<double>{link[P::p_x], link[P::p_y], link[P::p_z]};
  out[P::cos_gamma] = zxz.gamma.cos;
  out[P::sin_gamma] = zxz.gamma.sin;
  out[P::cos_alpha] = zxz.alpha.cos;
  out[P::sin_alpha] = zxz.alpha.sin;
  out[P::p_x] = origin.x;
  out[P::p_y] = origin.y;
  out[P::p_z] = origin.z;
  if (kind == JointKind::revolute) {
    out[P::offset] = link[P::offset] + zxz.beta;
  } else {
    const Angle turn = zxz.beta == 0 ? Angle{} : Angle::radians(zxz.beta);
    out[P::cos_beta] = turn.cos * link[P::cos_beta] - turn.sin * link[P::sin_beta];
    out[P::sin_beta] = turn.sin * link[P::cos_beta] + turn.cos * link[P::sin_beta];
  }
  return out;
}

namespace detail {

/// The turn about z from the given frame of link `i` to the model's, `R_model = R_given Rz(turn)`: the gamma
/// of its first child, which so has 0; none without a child.
inline Angle own_turn(std::size_t i, std::size_t n, const int* parents, const PlacedLink* placed) noexcept {
  for (std::size_t c = i + 1; c < n; ++c)
    if (parents[c] == static_cast<int>(i)) return decompose_zxz(placed[c].R).gamma;
  return {};
}

/// `canonical_links` of a tree whose topology is known at run time: `n` links, all arrays of that length.
inline void canonicalise(std::size_t n, const int* parents, const JointKind* kinds, const PlacedLink* placed,
                         LinkParameters<double>* links, double* turns) {
  for (std::size_t i = 0; i < n; ++i) {
    require(rotation_error(placed[i].R) <= 1e-6, "|R'R - 1| of a link's placement",
            rotation_error(placed[i].R), "<= 1e-6");
    turns[i] = 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    // In the parent's frame after its rotation for its own first child.
    Zxz angles = decompose_zxz(placed[i].R);
    JointPlacement placement;
    for (std::size_t k = 0; k < 3; ++k) placement.p[k] = placed[i].p[k];
    if (parents[i] >= 0) {
      std::size_t eldest = 0;
      while (parents[eldest] != parents[i]) ++eldest;
      const Angle turn = decompose_zxz(placed[eldest].R).gamma;
      const Angle g = angles.gamma;
      angles.gamma = {g.cos * turn.cos + g.sin * turn.sin, g.sin * turn.cos - g.cos * turn.sin};
      if (g.cos == turn.cos && g.sin == turn.sin) angles.gamma = {};
      const double x = placement.p[0], y = placement.p[1];
      placement.p[0] = turn.cos * x + turn.sin * y;
      placement.p[1] = turn.cos * y - turn.sin * x;
    }
    const Angle own = own_turn(i, n, parents, placed);
    turns[i] = std::atan2(own.sin, own.cos);
    placement.gamma = angles.gamma;
    placement.alpha = angles.alpha;
    const double beta = angles.beta + turns[i];
    if (kinds[i] == JointKind::revolute) {
      placement.offset = beta;
    } else if (beta != 0) {
      placement.beta = Angle::radians(beta);
    }
    links[i] = make_link(placement, turned_back_z(placed[i].inertia, own));
  }
}

}  // namespace detail

/// Converts placed links, in the order of `Tree`, to links of a model. Exact up to rounding for every
/// placement, parallel and near-parallel axes included. Throws `ConfigurationError` for axes that are no
/// rotation (error above 1e-6).
template <Topology Tree>
[[nodiscard]] TurnedLinks<Tree> canonical_links(const std::array<PlacedLink, Tree::joints>& placed) {
  TurnedLinks<Tree> out;
  detail::canonicalise(Tree::joints, Tree::parents.data(), Tree::kinds.data(), placed.data(),
                       out.links.data(), out.turn.data());
  return out;
}

SKINCTL_END_NAMESPACE
