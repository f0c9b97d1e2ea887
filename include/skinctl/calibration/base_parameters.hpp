// The inertial parameters that joint torques show: base parameters.
#pragma once

#include <Eigen/Core>
#include <random>
#include <utility>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/regressor.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Which columns of the regressor are independent, and how the others depend on them: `Y = Y_base K`,
/// `theta_base = K theta`.
struct BaseParameters {
  std::vector<int> columns;  ///< of the regressor, independent ones
  Eigen::MatrixXd K;         ///< base parameters of a parameter vector

  [[nodiscard]] int count() const noexcept { return int(columns.size()); }
};

namespace detail {

/// `A P = Q R`, by Gram and Schmidt's method, twice for each column; the column that is farthest from those before it comes next.
struct PivotedColumns {
  Eigen::MatrixXd R;                ///< rows to `rank`, columns in `order`
  std::vector<Eigen::Index> order;  ///< of A's columns
  Eigen::Index rank = 0;            ///< columns farther off than `tolerance` times the first

  PivotedColumns(Eigen::MatrixXd A, double tolerance) {
    const Eigen::Index n = A.cols();
    R = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index k = 0; k < n; ++k) order.push_back(k);
    for (; rank < n; ++rank) {
      Eigen::Index next = rank;
      double most = -1;
      for (Eigen::Index j = rank; j < n; ++j)
        if (const double size = A.col(j).norm(); size > most) most = size, next = j;
      if (!(most > tolerance * (rank == 0 ? 0 : R(0, 0)))) return;
      for (Eigen::Index i = 0; i < A.rows(); ++i) std::swap(A(i, rank), A(i, next));
      for (Eigen::Index i = 0; i < rank; ++i) std::swap(R(i, rank), R(i, next));
      std::swap(order[std::size_t(rank)], order[std::size_t(next)]);
      R(rank, rank) = most;
      A.col(rank) /= most;
      for (Eigen::Index j = rank + 1; j < n; ++j)
        for (int round = 0; round < 2; ++round) {
          const double along = A.col(rank).dot(A.col(j));
          R(rank, j) += along;
          A.col(j) -= along * A.col(rank);
        }
    }
  }
};

}  // namespace detail

/// By a pivoted QR of the column-scaled regressor at 200 random states. A UR5 has 36 of 60.
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
  BaseParameters out;
  const detail::PivotedColumns qr(A * scale.cwiseInverse().asDiagonal(), tolerance);
  const Eigen::Index n = A.cols(), rank = qr.rank;
  out.K = Eigen::MatrixXd::Zero(rank, n);
  for (Eigen::Index k = 0; k < rank; ++k) {
    const int own = int(qr.order[std::size_t(k)]);
    out.columns.push_back(own);
    out.K(k, own) = 1;
  }
  for (Eigen::Index j = rank; j < n; ++j) {
    const Eigen::Index column = qr.order[std::size_t(j)];
    for (Eigen::Index k = rank; k-- > 0;) {  // R x = r, from below
      double x = qr.R(k, j);
      for (Eigen::Index i = k + 1; i < rank; ++i)
        x -= qr.R(k, i) * out.K(i, column) * scale(out.columns[std::size_t(i)]);
      out.K(k, column) = x / qr.R(k, k) / scale(out.columns[std::size_t(k)]);
    }
    for (Eigen::Index k = 0; k < rank; ++k) out.K(k, column) *= scale(column);
  }
  return out;
}

SKINCTL_END_NAMESPACE
