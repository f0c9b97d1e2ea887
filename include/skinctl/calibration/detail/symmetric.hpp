// SPDX-License-Identifier: BSD-3-Clause
// Decompositions of symmetric matrices, of any size: one instantiation of Eigen's for all fits.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

// Each fixed size is another instantiation of everything in Eigen below a decomposition, seconds for the
// compiler. Fits run at configuration time: here all are `MatrixXd`.

/// Eigenvalues in ascending order, with unit eigenvectors as columns. NaN where A is not finite.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;

  explicit SymmetricEigen(const Eigen::MatrixXd& A) {
    values = Eigen::VectorXd::Constant(A.rows(), std::numeric_limits<double>::quiet_NaN());
    vectors = Eigen::MatrixXd::Identity(A.rows(), A.rows());
    if (!A.allFinite()) return;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
    values = eigen.eigenvalues(), vectors = eigen.eigenvectors();
  }
  [[nodiscard]] double largest() const { return values(values.size() - 1); }
};

/// `A = L L'`. `positive()` is false if A is not positive definite, or not finite; `solve` then means
/// nothing.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& A) { compute(A); }
  void compute(const Eigen::MatrixXd& A) {
    llt_.compute(A);
    positive_ = A.allFinite() && llt_.info() == Eigen::Success;
  }
  [[nodiscard]] bool positive() const noexcept { return positive_; }
  /// An element of L, for `row >= column`.
  [[nodiscard]] double factor(Eigen::Index row, Eigen::Index column) const {
    return llt_.matrixLLT()(row, column);
  }
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return llt_.solve(b); }
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    return solve(Eigen::MatrixXd::Identity(llt_.rows(), llt_.rows()));
  }
  /// `log det A`.
  [[nodiscard]] double log_determinant() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < llt_.rows(); ++i) sum += 2 * std::log(factor(i, i));
    return sum;
  }
  /// The square `b' A^-1 b` of a column `b`.
  [[nodiscard]] double squared(const Eigen::MatrixXd& b) const { return b.cwiseProduct(solve(b)).sum(); }

 private:
  Eigen::LLT<Eigen::MatrixXd> llt_;
  bool positive_ = false;
};

/// Solves `A x = b` by `A = L D L'` with pivots: also where A is singular, or only almost positive.
[[nodiscard]] inline Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(b);
}

/// The shortest of the `x` with which `A x` comes nearest to `b`, A not negative: along what A shows less
/// than `share` of the most, it does not go.
[[nodiscard]] inline Eigen::VectorXd shortest_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                                       double share = 1e-10) {
  const SymmetricEigen eigen(A);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  for (Eigen::Index k = 0; k < b.size(); ++k)
    if (eigen.values(k) > share * eigen.largest())
      x += eigen.vectors.col(k) * (eigen.vectors.col(k).dot(b) / eigen.values(k));
  return x;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
