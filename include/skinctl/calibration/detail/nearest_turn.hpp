// SPDX-License-Identifier: BSD-3-Clause
// The rotation that is nearest to a matrix: what remains of a correlation of directions.
#pragma once

#include <Eigen/Core>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/turn.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// The rotation R that maximises `trace(R' B)`, by Horn's quaternion; never a mirror. Of `B = sum a b'` it
/// maps the b onto the a.
inline Eigen::Matrix3d nearest_turn(const Eigen::Matrix3d& B) {
  Eigen::MatrixXd K(4, 4);
  K(0, 0) = B(0, 0) + B(1, 1) + B(2, 2);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    K(0, 1 + i) = K(1 + i, 0) = B(k, j) - B(j, k);
    K(1 + i, 1 + i) = B(i, i) - B(j, j) - B(k, k);
    K(1 + i, 1 + j) = K(1 + j, 1 + i) = B(i, j) + B(j, i);
  }
  const Eigen::MatrixXd q = SymmetricEigen(K).vectors.rightCols(1);
  const Eigen::Vector3d v(q(1), q(2), q(3));
  Eigen::Matrix3d R = 2 * q(0) * cross_matrix(v);
  for (int i = 0; i < 3; ++i) {
    R(i, i) += q(0) * q(0) - v.squaredNorm();
    for (int j = 0; j < 3; ++j) R(i, j) += 2 * v(i) * v(j);
  }
  return R;
}

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
