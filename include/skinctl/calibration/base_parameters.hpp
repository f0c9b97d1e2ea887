// SPDX-License-Identifier: BSD-3-Clause
// The inertial parameters that joint torques show: base parameters.
#pragma once

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>
#include <random>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/regressor.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The independent columns of the regressor, and the dependence of the others on them: `Y = Y_base K`,
/// `theta_base = K theta`.
struct BaseParameters {
  std::vector<int> columns;  ///< indices of independent columns of the regressor
  Eigen::MatrixXd K;         ///< map of a parameter vector to its base parameters

  [[nodiscard]] int count() const noexcept { return int(columns.size()); }
};

/// The base parameters of a model, by a pivoted QR of the column-scaled regressor at 200 random states. A UR5
/// has 36 of 60. `tolerance`: smallest pivot of an independent column, relative to the largest.
template <RobotModel M>
[[nodiscard]] BaseParameters base_parameters(const M& model, double tolerance = 1e-7) {
  constexpr std::size_t N = M::joints;
  using detail::fit::operator+, detail::fit::operator-, detail::fit::operator*,
      detail::fit::operator/;  // of Eigen alone
  std::mt19937_64 rng(1);
  const auto random = [&](double size) { return size * (double(rng() >> 11) * 0x1p-52 - 1); };
  Eigen::MatrixXd A(200 * Eigen::Index(N), 10 * Eigen::Index(N));
  for (Eigen::Index k = 0; k < 200; ++k) {
    JointPosition<N> q;
    JointVelocity<N> dq;
    JointAcceleration<N> ddq;
    for (std::size_t i = 0; i < N; ++i) q[i] = random(3.1), dq[i] = random(3), ddq[i] = random(10);
    A.middleRows(k * Eigen::Index(N), Eigen::Index(N)) = as_eigen(regressor(model, q, dq, dq, ddq));
  }
  Eigen::VectorXd scale = A.colwise().norm();
  for (double& s : scale) s = s > 1e-12 ? s : 1;
  const Eigen::MatrixXd scaled = A * scale.cwiseInverse().asDiagonal();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  const auto& R = qr.matrixR();
  BaseParameters out;
  const Eigen::Index n = scaled.cols();
  Eigen::Index rank = 0;
  while (rank < n && std::abs(R(rank, rank)) > tolerance * std::abs(R(0, 0))) ++rank;
  const Eigen::MatrixXd dependent = R.topLeftCorner(rank, rank)
                                        .template triangularView<Eigen::Upper>()
                                        .solve(Eigen::MatrixXd(R.topRightCorner(rank, n - rank)));
  out.K = Eigen::MatrixXd::Zero(rank, n);
  const auto& order = qr.colsPermutation().indices();
  for (Eigen::Index k = 0; k < rank; ++k) {
    out.columns.push_back(order(k));
    out.K(k, order(k)) = 1;
    for (Eigen::Index j = rank; j < n; ++j)
      out.K(k, order(j)) = dependent(k, j - rank) * scale(order(j)) / scale(order(k));
  }
  return out;
}

SKINCTL_END_NAMESPACE
