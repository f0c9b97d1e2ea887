// SPDX-License-Identifier: BSD-3-Clause
// Inertial parameters that a body can have: their pseudo-inertia.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

using Inertia10 = Eigen::Matrix<double, 10, 1>;

/// The pseudo-inertia `P = [Sigma h; h' m]` of mass m, first moments h and second moments Sigma of mass;
/// positive definite for every body.
inline Eigen::Matrix4d pseudo_inertia(const Inertia10& t) noexcept {
  Eigen::Matrix4d P;
  const double half = 0.5 * (t(4) + t(5) + t(6));
  P << half - t(4), -t(7), -t(8), t(1), -t(7), half - t(5), -t(9), t(2), -t(8), -t(9), half - t(6), t(3),
      t(1), t(2), t(3), t(0);
  return P;
}
inline Inertia10 parameters_of(const Eigen::Matrix4d& P) noexcept {
  Inertia10 t;
  t << P(3, 3), P(0, 3), P(1, 3), P(2, 3), P(1, 1) + P(2, 2), P(0, 0) + P(2, 2), P(0, 0) + P(1, 1), -P(0, 1),
      -P(0, 2), -P(1, 2);
  return t;
}

/// The body nearest to `t`, lengths measured in `reach` [m]: second moments below a ten-thousandth of the
/// largest are raised to it.
inline Inertia10 body_near(const Inertia10& t, double reach) {
  Eigen::MatrixXd P = pseudo_inertia(t);
  const auto scale = [reach](int i) { return i < 3 ? reach : 1; };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) P(i, j) /= scale(i) * scale(j);
  const SymmetricEigen eigen(P);
  const double least = std::max(1e-12, 1e-4 * eigen.largest());
  Eigen::MatrixXd raised = eigen.vectors;
  for (int k = 0; k < 4; ++k) raised.col(k) *= std::max(eigen.values(k), least);
  Eigen::Matrix4d out = raised * eigen.vectors.transpose();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out(i, j) *= scale(i) * scale(j);
  return parameters_of(out);
}

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
