// SPDX-License-Identifier: BSD-3-Clause
// The accelerometer of a skin cell: its equation, and what is known of it before it is calibrated.
#pragma once

#include "skinctl/calibration/turn.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The errors of an accelerometer. Its reading, in g, is
/// ```
/// y = (1 + s) o Q' f + b,   Q = R turn(m),   f = (a - gravity) / |gravity|
/// ```
/// with `R` the axes of the cell and `f` the specific force at its origin, both in one frame; `o` multiplies
/// element by element.
struct AccelerometerErrors {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();   ///< bias b of the reading [g]
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();  ///< relative error s of the scale [1]
  /// Rotation vector m of the soldered sensor in its cell [rad].
  Eigen::Vector3d misalignment = Eigen::Vector3d::Zero();
};

/// Standard deviations of `AccelerometerErrors` by the maker's word, each axis: of a BMA250, soldered by
/// machine.
struct AccelerometerPrior {
  double bias = 0.040;                       ///< deviation of a bias [g]
  double scale = 0.015;                      ///< deviation of a scale [1]
  double misalignment = 0.7 * 0.0174532925;  ///< deviation of a misalignment [rad]; 0.2 deg if trimmed
};

/// The reading of an accelerometer, and its derivatives. A turn of the cell is `R turn(d)`.
struct AccelerometerReading {
  Eigen::Vector3d y;                ///< reading [g]
  Eigen::Matrix3d by_turn;          ///< derivative of `y` by a turn of the cell in its axes [g/rad]
  Eigen::Matrix3d by_force;         ///< derivative of `y` by the specific force in the outer frame [g/g]
  Eigen::Matrix3d by_misalignment;  ///< derivative of `y` by the sensor's misalignment [g/rad]
  Eigen::Vector3d by_scale;  ///< diagonal of the derivative of `y` by the scale [g]; that by the bias is 1
};

/// The reading [g] of a cell with the axes `R` where the specific force is `f` [g]: without noise.
[[nodiscard]] inline Eigen::Vector3d reading(const Eigen::Matrix3d& R, const AccelerometerErrors& e,
                                             const Eigen::Vector3d& f) noexcept {
  const Eigen::Vector3d u = turn(e.misalignment).transpose() * (R.transpose() * f);
  return (Eigen::Vector3d::Ones() + e.scale).cwiseProduct(u) + e.bias;
}

/// The reading of `reading(R, e, f)`, with its derivatives.
[[nodiscard]] inline AccelerometerReading reading_and_derivatives(const Eigen::Matrix3d& R,
                                                                  const AccelerometerErrors& e,
                                                                  const Eigen::Vector3d& f) noexcept {
  const Eigen::Matrix3d M_t = turn(e.misalignment).transpose();
  const Eigen::Vector3d v = R.transpose() * f, u = M_t * v;
  const Eigen::DiagonalMatrix<double, 3> S((Eigen::Vector3d::Ones() + e.scale).eval());
  AccelerometerReading out;
  out.y = S * u + e.bias;
  out.by_turn = S * (M_t * cross_matrix(v));
  out.by_force = S * (M_t * R.transpose());
  out.by_misalignment = S * (cross_matrix(u) * right_jacobian(e.misalignment));
  out.by_scale = u;
  return out;
}

SKINCTL_END_NAMESPACE
