// Inertial parameters that a body can have: by the factor of its pseudo-inertia.
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

/// `P = [Sigma h; h' m]` with second moments of mass Sigma; positive definite for every body.
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

/// Ten free numbers of a body: `P = U U'`, U upper triangular in lengths of `reach`, its diagonal by logarithm.
struct BodyFactor {
  double reach = 0.2;  ///< [m]
  Inertia10 x = Inertia10::Zero();

  static constexpr int row[10] = {0, 1, 2, 3, 0, 0, 0, 1, 1, 2}, column[10] = {0, 1, 2, 3, 1, 2, 3, 2, 3, 3};

  [[nodiscard]] Eigen::Matrix4d factor() const noexcept {
    Eigen::Matrix4d U = Eigen::Matrix4d::Zero();
    for (int k = 0; k < 10; ++k)
      U(row[k], column[k]) = k < 4 ? std::exp(std::clamp(x(k), -40.0, 40.0)) : x(k);
    U.topRows<3>() *= reach;
    return U;
  }
  [[nodiscard]] Inertia10 parameters() const noexcept {
    const Eigen::Matrix4d U = factor();
    return parameters_of(U * U.transpose());
  }
  [[nodiscard]] Eigen::Matrix<double, 10, 10> derivative() const noexcept {
    const Eigen::Matrix4d U = factor();
    Eigen::Matrix<double, 10, 10> D;
    for (int k = 0; k < 10; ++k) {
      Eigen::Matrix4d dU = Eigen::Matrix4d::Zero();
      dU(row[k], column[k]) = k < 4 ? U(row[k], column[k]) : (row[k] < 3 ? reach : 1);
      const Eigen::Matrix4d dP = dU * U.transpose();
      D.col(k) = parameters_of(dP + dP.transpose());
    }
    return D;
  }
  /// The body nearest to `t`: negative second moments become small ones.
  [[nodiscard]] static BodyFactor of(const Inertia10& t, double reach) {
    Eigen::MatrixXd P = pseudo_inertia(t);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) P(i, j) /= (i < 3 ? reach : 1) * (j < 3 ? reach : 1);
    const SymmetricEigen eigen(P);
    const double least = std::max(1e-12, 1e-4 * eigen.largest());
    Eigen::MatrixXd scaled = eigen.vectors;
    for (int k = 0; k < 4; ++k) scaled.col(k) *= std::max(eigen.values(k), least);
    P.noalias() = scaled * eigen.vectors.transpose();
    // Upper triangular: from the last row up.
    Eigen::Matrix4d U = Eigen::Matrix4d::Zero();
    for (int j = 3; j >= 0; --j)
      for (int i = j; i >= 0; --i) {
        double sum = P(i, j);
        for (int k = j + 1; k < 4; ++k) sum -= U(i, k) * U(j, k);
        U(i, j) = i == j ? std::sqrt(std::max(sum, 1e-24)) : sum / U(j, j);
      }
    BodyFactor out;
    out.reach = reach;
    for (int k = 0; k < 10; ++k) out.x(k) = k < 4 ? std::log(U(row[k], column[k])) : U(row[k], column[k]);
    return out;
  }
};

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
