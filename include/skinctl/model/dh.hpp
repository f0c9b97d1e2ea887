// SPDX-License-Identifier: BSD-3-Clause
// Tables of Denavit and Hartenberg as links of a model.
#pragma once

#include "skinctl/model/link.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One row of a table of Denavit and Hartenberg. A revolute joint adds its position to `theta`, a prismatic
/// one to `d`.
struct DhRow {
  double theta = 0;  ///< angle about the joint's axis [rad]
  double d = 0;      ///< offset along the joint's axis [m]
  double a = 0;      ///< length of the common normal [m]
  Angle alpha{};     ///< angle from this joint's axis to the next; `Angle::quarter(k)` keeps it exact
};

/// The end of a standard row in the link's frame of the model: the next joint, or after the last row the
/// flange.
constexpr JointPlacement row_end(const DhRow& row, JointKind kind = JointKind::revolute) noexcept {
  return {.p = {row.a, 0, kind == JointKind::revolute ? row.d : 0.0}, .alpha = row.alpha};
}

/// An inertia given in a frame at `frame.p`, rotated by `Rx(alpha)`, expressed in the outer frame.
constexpr LinkInertia moved_out(const JointPlacement& frame, const LinkInertia& in) noexcept {
  const double c = frame.alpha.cos, s = frame.alpha.sin;
  LinkInertia out;
  out.mass = in.mass;
  out.c[0] = frame.p[0] + in.c[0];
  out.c[1] = frame.p[1] + c * in.c[1] - s * in.c[2];
  out.c[2] = frame.p[2] + s * in.c[1] + c * in.c[2];
  out.xx = in.xx;
  out.yy = c * c * in.yy - 2 * c * s * in.yz + s * s * in.zz;
  out.zz = s * s * in.yy + 2 * c * s * in.yz + c * c * in.zz;
  out.xy = c * in.xy - s * in.xz;
  out.xz = s * in.xy + c * in.xz;
  out.yz = c * s * (in.yy - in.zz) + (c * c - s * s) * in.yz;
  return out;
}

/// A chain from a standard table: row i is `Rz(theta) Tz(d) Tx(a) Rx(alpha)`. The frame of link i in the
/// model lies directly after the joint's motion; each inertia is given, as makers do, in the frame at the end
/// of its row. Exact: only the inertias are rounded.
template <std::size_t N>
[[nodiscard]] constexpr std::array<LinkParameters<double>, N> links_from_standard_dh(
    const std::array<DhRow, N>& rows, const std::array<LinkInertia, N>& at_row_ends,
    const std::array<JointKind, N>& kinds = all_of_kind<N>(JointKind::revolute)) noexcept {
  std::array<LinkParameters<double>, N> links;
  JointPlacement placement;
  for (std::size_t i = 0; i < N; ++i) {
    const JointPlacement end = row_end(rows[i], kinds[i]);
    links[i] = make_link(placement, moved_out(end, at_row_ends[i]));
    if (kinds[i] == JointKind::revolute) {
      links[i][LinkParameter::offset] = rows[i].theta;
    } else {
      const Angle turn = rows[i].theta == 0 ? Angle{} : Angle::radians(rows[i].theta);
      links[i][LinkParameter::offset] = rows[i].d;
      links[i][LinkParameter::cos_beta] = turn.cos;
      links[i][LinkParameter::sin_beta] = turn.sin;
    }
    placement = end;
  }
  return links;
}

SKINCTL_END_NAMESPACE
