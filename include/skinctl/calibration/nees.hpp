// SPDX-License-Identifier: BSD-3-Clause
// Whether covariances tell the truth.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "skinctl/calibration/detail/symmetric.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Normalised estimation error squared, `e' C^-1 e`: of a covariance that tells the truth its mean is the
/// length of `e`. NaN if `C` is not positive definite.
[[nodiscard]] inline double nees(const Eigen::VectorXd& e, const Eigen::MatrixXd& C) {
  const detail::Cholesky factor(C);
  return factor.positive() ? factor.squared(e) : std::numeric_limits<double>::quiet_NaN();
}

SKINCTL_END_NAMESPACE
