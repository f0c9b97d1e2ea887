// Decompositions of symmetric matrices, of any size: one instantiation of Eigen's for all fits.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

// Each fixed size is another instantiation of everything in Eigen below a decomposition, seconds for the compiler. Fits run at
// configuration time: here all are `MatrixXd`.

/// Eigenvalues in ascending order, with unit eigenvectors as columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;

  explicit SymmetricEigen(const Eigen::MatrixXd& A) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(A);
    values = eigen.eigenvalues(), vectors = eigen.eigenvectors();
  }
  [[nodiscard]] double largest() const { return values(values.size() - 1); }
};

/// `A = L L'`. `positive()` is false if A is not positive definite; `solve` then means nothing.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& A) { compute(A); }
  void compute(const Eigen::MatrixXd& A) { llt_.compute(A); }
  [[nodiscard]] bool positive() const { return llt_.info() == Eigen::Success; }
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return llt_.solve(b); }
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    return solve(Eigen::MatrixXd::Identity(llt_.rows(), llt_.rows()));
  }
  /// `log det A`.
  [[nodiscard]] double log_determinant() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < llt_.rows(); ++i) sum += 2 * std::log(llt_.matrixLLT()(i, i));
    return sum;
  }
  /// `b' A^-1 b` of a column.
  [[nodiscard]] double squared(const Eigen::MatrixXd& b) const { return b.cwiseProduct(solve(b)).sum(); }

 private:
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

/// `A^-1 b`, by `A = L D L'` with pivots: also where A is singular, or only almost positive.
[[nodiscard]] inline Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return Eigen::LDLT<Eigen::MatrixXd>(A).solve(b);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
