// SPDX-License-Identifier: BSD-3-Clause
// A pose of a skin file.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A pose of a skin file: origin [m], and the axes as a unit quaternion x, y, z, w.
struct SkinPose {
  Xyz<double> p{0, 0, 0};
  std::array<double, 4> q{0, 0, 0, 1};

  /// The axes; exact for a quaternion that is of unit length only to within rounding.
  [[nodiscard]] Rotation<double> rotation() const {
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
            {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
            {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  }
  /// The pose with axes `R` and origin `p`; `w >= 0`.
  [[nodiscard]] static SkinPose of(const Rotation<double>& R, const Xyz<double>& p) {
    const Mat3<double> matrix = as_eigen(R);
    Eigen::Quaterniond q(matrix);
    q.normalize();
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    return {p, {q.x(), q.y(), q.z(), q.w()}};
  }

  friend bool operator==(const SkinPose&, const SkinPose&) = default;
};

SKINCTL_END_NAMESPACE
