// SPDX-License-Identifier: BSD-3-Clause
// A robot model from the lines of its joints: links for a `CalibratedModel`, places of cells on links, a
// table of Denavit and Hartenberg.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/line_motion.hpp"
#include "skinctl/model/dh.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One row of the table that is shown: `Rz(q + theta) Tz(d) Tx(a) Rx(alpha)`.
struct ShownDhRow {
  double theta = 0, d = 0, a = 0, alpha = 0;  ///< angles [rad] and lengths [m] of the row
  bool parallel = false;  ///< axis parallel to the next one within half a degree: d is then a choice, and 0
};

/// A chain of revolute joints by its axes. Its base is upright, at the foot of the first axis nearest to the
/// second, x along the common normal where the first joint's position is zero.
template <std::size_t N>
struct LineModel {
  std::array<LinkParameters<double>, N> links;  ///< parameters of the links, without masses
  Eigen::Isometry3d base;                       ///< pose of the model's base in the frame of the given lines
  /// Poses of the links' frames at home, in the frame of the given lines.
  std::array<Eigen::Isometry3d, N> at_home;
  /// DH rows of the joints; the last row ends in the last link: d = a = alpha = 0.
  std::array<ShownDhRow, N> table;

  /// A model of `Tree`, a chain; without masses until an inertial fit gives them.
  template <Topology Tree>
  [[nodiscard]] CalibratedModel<Tree> model(double gravity = 9.81) const {
    static_assert(Tree::joints == N);
    return CalibratedModel<Tree>(links, {0.0, 0.0, -gravity});
  }
  /// The table as text, lengths in mm, angles in degrees.
  [[nodiscard]] std::string text() const {
    std::string out = "joint  theta [deg]     d [mm]     a [mm]  alpha [deg]\n";
    for (std::size_t i = 0; i < N; ++i) {
      char row[120];
      std::snprintf(row, sizeof row, "%5zu %12.3f %10.2f %10.2f %12.3f%s\n", i, table[i].theta * 57.29577951,
                    table[i].d * 1e3, table[i].a * 1e3, table[i].alpha * 57.29577951,
                    table[i].parallel ? "  parallel to the next: d is a choice" : "");
      out += row;
    }
    return out;
  }
};

namespace detail::fit {
/// The feet of the common normal on two lines; of parallel ones at the first's `point`.
struct CommonNormal {
  Eigen::Vector3d first, second, x;
  bool parallel;
};
inline CommonNormal common_normal(const AxisLine& a, const AxisLine& b) {
  const Eigen::Vector3d n = a.direction.cross(b.direction), d = b.point - a.point;
  const double square = n.squaredNorm();
  CommonNormal out;
  out.parallel = square < 7.6e-5;  // half a degree
  if (out.parallel) {
    out.first = a.point;
    out.second = b.point + b.direction * b.direction.dot(a.point - b.point);
    const Eigen::Vector3d across = out.second - out.first;
    out.x = across.norm() > 1e-6 ? Eigen::Vector3d(across.normalized()) : a.direction.unitOrthogonal();
    out.x = (out.x - a.direction * a.direction.dot(out.x)).normalized();
    return out;
  }
  out.first = a.point + a.direction * (d.cross(b.direction).dot(n) / square);
  out.second = b.point + b.direction * (d.cross(a.direction).dot(n) / square);
  out.x = n / std::sqrt(square);
  return out;
}
inline double angle_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}
}  // namespace detail::fit

/// The model of a chain of revolute joints, from its axes at home. Throws `ConfigurationError` for a
/// direction that is no unit vector.
///
/// @param lines  axes of the joints at home, all in one frame with z up: unit directions, any point of each
///               [m].
/// @param home   positions of the joints there [rad].
template <std::size_t N>
[[nodiscard]] LineModel<N> line_model(const std::array<AxisLine, N>& lines,
                                      const std::array<double, N>& home) {
  static_assert(N >= 2, "a single axis has no common normal");
  using Vec = Eigen::Vector3d;
  using detail::fit::operator+, detail::fit::operator-, detail::fit::operator*,
      detail::fit::operator/;  // of Eigen alone
  LineModel<N> out;
  std::array<Vec, N> x, origin;
  // Frames of the links: x normal to the own axis and the next, origins at the feet of common normals.
  for (std::size_t i = 0; i < N; ++i) {
    const Vec& z = lines[i].direction;
    require(std::abs(z.norm() - 1) < 1e-6 && lines[i].point.allFinite(), "direction of a line", z.norm(),
            "1");
    AxisLine here = lines[i];
    if (i > 0) here.point = origin[i];
    if (i + 1 == N) {
      x[i] = detail::fit::turned(x[i - 1] - z * z.dot(x[i - 1]), z, std::cos(home[i]), std::sin(home[i]))
                 .normalized();
      break;
    }
    const auto normal = detail::fit::common_normal(here, lines[i + 1]);
    if (i == 0) origin[0] = normal.parallel ? here.point : normal.first;
    origin[i + 1] = normal.second;
    // Exactly normal to both, also where they are almost parallel.
    const Vec n = z.cross(lines[i + 1].direction);
    x[i] = n.norm() > 1e-9 ? Vec(n.normalized()) : normal.x;
  }
  const Vec& z0 = lines[0].direction;
  const Vec up = Vec::UnitZ();
  // The base: x along the first link's at zero, as upright as the base of the lines.
  const Vec x0 = detail::fit::turned(x[0], z0, std::cos(home[0]), -std::sin(home[0]));
  Eigen::Matrix3d B;
  const Vec bx =
      (x0 - up * up.dot(x0)).norm() > 1e-3 ? Vec((x0 - up * up.dot(x0)).normalized()) : up.unitOrthogonal();
  B << bx, up.cross(bx), up;
  out.base = Eigen::Isometry3d::Identity();
  out.base.linear() = B, out.base.translation() = origin[0];

  Eigen::Matrix3d parent = B;
  Vec parent_origin = origin[0];
  for (std::size_t i = 0; i < N; ++i) {
    const Vec& z = lines[i].direction;
    JointPlacement placement;
    Vec turned_x = parent.col(0);
    if (i == 0) {  // any direction: gamma
      const Vec n = up.cross(z);
      if (n.norm() > 1e-9) turned_x = n.normalized();
      placement.gamma = Angle::radians(detail::fit::angle_about(up, parent.col(0), turned_x));
    }
    placement.alpha = Angle::radians(detail::fit::angle_about(turned_x, parent.col(2), z));
    const Vec p = parent.transpose() * (origin[i] - parent_origin);
    for (Eigen::Index k = 0; k < 3; ++k) placement.p[k] = p(k);
    placement.offset =
        std::remainder(detail::fit::angle_about(z, turned_x, x[i]) - home[i], 6.283185307179586);
    out.links[i] = make_link(placement, {});
    Eigen::Matrix3d R;
    R << x[i], z.cross(x[i]), z;
    out.at_home[i] = Eigen::Isometry3d::Identity();
    out.at_home[i].linear() = R, out.at_home[i].translation() = origin[i];
    parent = R, parent_origin = origin[i];
  }
  // The shown table: common normals, of parallel axes from foot to foot.
  Vec last = x0;
  Vec foot = origin[0];
  for (std::size_t i = 0; i < N; ++i) {
    auto& row = out.table[i];
    const Vec& z = lines[i].direction;
    if (i + 1 == N) {
      row.theta = 0;
      break;
    }
    AxisLine here = lines[i];
    here.point = foot;
    const auto normal = detail::fit::common_normal(here, lines[i + 1]);
    row.parallel = normal.parallel;
    const double offset = std::remainder(
        detail::fit::angle_about(z, last - z * z.dot(last), normal.x) - home[i], 6.283185307179586);
    row.theta = i == 0 ? 0 : offset;
    row.d = normal.parallel ? 0 : z.dot(normal.first - foot);
    row.a = (normal.second - normal.first).dot(normal.x);
    row.alpha = detail::fit::angle_about(normal.x, z, lines[i + 1].direction);
    last = normal.x, foot = normal.second;
  }
  return out;
}

SKINCTL_END_NAMESPACE
