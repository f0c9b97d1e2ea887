// SPDX-License-Identifier: BSD-3-Clause
// Rotations of a fit, as Eigen matrices: exp, log, and the matrix of a cross product.
#pragma once

#include <Eigen/Core>

#include "skinctl/frames/rotation.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The matrix `[v]` of a cross product: `[v] w = v x w`.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) noexcept {
  Eigen::Matrix3d M;
  M << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return M;
}

/// The rotation by `|phi|` [rad] about `phi`; see `exp_so3`.
[[nodiscard]] inline Eigen::Matrix3d turn(const Eigen::Vector3d& phi) noexcept {
  return as_eigen(exp_so3(Xyz<double>{phi.x(), phi.y(), phi.z()}));
}

/// The shortest rotation vector of `R` [rad]; see `log_so3`.
[[nodiscard]] inline Eigen::Vector3d turn_vector(const Eigen::Matrix3d& R) noexcept {
  return as_eigen(log_so3(Rotation<double>::from_eigen(R)));
}

/// The right Jacobian `J_r(phi)` of a rotation: `turn(phi + d) = turn(phi) turn(J_r d)` to first order in
/// `d`.
[[nodiscard]] inline Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) noexcept {
  const Xyz<double> back{-phi.x(), -phi.y(), -phi.z()};
  Eigen::Matrix3d J;
  J.col(0) = as_eigen(left_jacobian_so3(back, Xyz<double>{1, 0, 0}));
  J.col(1) = as_eigen(left_jacobian_so3(back, Xyz<double>{0, 1, 0}));
  J.col(2) = as_eigen(left_jacobian_so3(back, Xyz<double>{0, 0, 1}));
  return J;
}

/// The rotation nearest to `R`, which rounding has moved off by a little.
[[nodiscard]] inline Eigen::Matrix3d straightened(const Eigen::Matrix3d& R) noexcept {
  return as_eigen(normalised(Rotation<double>::from_eigen(R)));
}

SKINCTL_END_NAMESPACE
