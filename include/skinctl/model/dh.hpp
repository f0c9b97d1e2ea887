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
  Angle alpha{};     ///< `Angle::quarter(k)` keeps right angles exact, and a static model folds them
};

/// The deviations of a factory calibration from the rows of a standard table, as in Universal Robots'
/// calibration.conf.
template <std::size_t N>
struct DhDelta {
  std::array<double, N> theta{};  ///< delta_theta [rad]
  std::array<double, N> a{};      ///< delta_a [m]
  std::array<double, N> d{};      ///< delta_d [m]
  std::array<double, N> alpha{};  ///< delta_alpha [rad]
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

/// One individual arm: its links, for a `CalibratedModel`, and the end of its last row (the flange) in the
/// last link's frame.
template <std::size_t N>
struct CalibratedDh {
  std::array<LinkParameters<double>, N> links;
  JointPlacement end;
};

/// A standard table of revolute joints and its factory calibration.
///
/// Where axes are nominally parallel, a calibration may place the common normal many metres away and rotate
/// it by large angles (delta_d of 90 m and delta_theta of 0.7 rad in a healthy UR10). The model's frames
/// therefore lie on the calibrated axes, but at the nominal height. The inertias, given at the ends of the
/// nominal rows, stay fixed to the physical links: the frames are rotated against these by the sum of
/// delta_theta since the last axis that was not parallel. Throws `ConfigurationError` for numbers that are
/// not finite, and for a delta_alpha beyond 0.1 rad, which no calibration has.
template <std::size_t N>
[[nodiscard]] CalibratedDh<N> calibrated_dh(const std::array<DhRow, N>& rows, const DhDelta<N>& delta,
                                            const std::array<LinkInertia, N>& at_row_ends) {
  CalibratedDh<N> out;
  JointPlacement placement;
  double slide = 0;  // of link i's frame along its axis, from the start of the calibrated row
  double turn = 0;   // of link i's frame about its axis, against the physical link
  for (std::size_t i = 0; i < N; ++i) {
    for (double x : {delta.theta[i], delta.a[i], delta.d[i]})
      require(x - x == 0, "calibration of a joint", x, "a finite number");
    require(delta.alpha[i] > -0.1 && delta.alpha[i] < 0.1, "delta_alpha", delta.alpha[i], "-0.1 to 0.1 rad");
    turn += delta.theta[i];
    out.links[i] = make_link(
        placement, turned_back_z(moved_out(row_end(rows[i]), at_row_ends[i]), Angle::radians(turn)));
    out.links[i][LinkParameter::offset] = rows[i].theta + delta.theta[i];
    const double c = std::cos(delta.alpha[i]), s = std::sin(delta.alpha[i]);
    const Angle nominal = rows[i].alpha;
    const Angle alpha{nominal.cos * c - nominal.sin * s, nominal.sin * c + nominal.cos * s};
    const double a = rows[i].a + delta.a[i];
    const double height = delta.d[i] - slide;  // beyond the nominal row
    out.end = {.p = {a, 0, rows[i].d + height}, .alpha = alpha};
    placement = out.end;
    const bool parallel = nominal.sin == 0;
    slide = parallel ? -height / alpha.cos : 0.0;
    if (parallel) {
      placement.p[1] = -slide * alpha.sin;
      placement.p[2] = rows[i].d;
    } else {
      turn = 0;
    }
  }
  return out;
}

SKINCTL_END_NAMESPACE
