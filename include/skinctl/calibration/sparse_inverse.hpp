// SPDX-License-Identifier: BSD-3-Clause
// The covariance of a large sparse fit: the elements of the inverse that belong to unknowns with a common
// term.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "skinctl/calibration/normal_equations.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The elements of `A^-1` where the Cholesky factor of `A` has elements: all blocks of the diagonal, and
/// those of unknowns that share a term. Takahashi's recursion, at about the cost of the factor; the whole
/// inverse of a patch of 500 cells would take a hundred times longer.
class SparseInverse {
 public:
  /// @param A  positive definite, its lower triangle. If it is not, `valid()` is false and all elements are
  ///           infinite.
  explicit SparseInverse(const SparseNormal::Matrix& A) {
    SparseNormal::Solver solver(A);
    valid_ = solver.info() == Eigen::Success && solver.vectorD().minCoeff() > 0;
    if (!valid_) return;
    place_ = solver.permutationP().indices();
    const auto& L = solver.matrixL().nestedExpression();
    const Eigen::VectorXd D = solver.vectorD();
    const int n = int(L.rows());
    Z_ = L;
    diagonal_.resize(n);
    std::vector<int> slot(std::size_t(n), -1);
    std::vector<double> sum;
    for (int j = n - 1; j >= 0; --j) {
      const int first = L.outerIndexPtr()[j], count = L.outerIndexPtr()[j + 1] - first;
      const int* rows = L.innerIndexPtr() + first;
      const double* l = L.valuePtr() + first;
      sum.assign(std::size_t(count), 0);
      for (int a = 0; a < count; ++a) slot[std::size_t(rows[a])] = a;
      for (int a = 0; a < count; ++a) {
        const int k = rows[a];
        sum[std::size_t(a)] += l[a] * diagonal_(k);
        for (int e = Z_.outerIndexPtr()[k]; e < Z_.outerIndexPtr()[k + 1]; ++e) {
          const int b = slot[std::size_t(Z_.innerIndexPtr()[e])];
          if (b < 0) continue;
          sum[std::size_t(b)] += l[a] * Z_.valuePtr()[e];
          sum[std::size_t(a)] += l[b] * Z_.valuePtr()[e];
        }
      }
      double own = 1 / D(j);
      for (int a = 0; a < count; ++a) {
        slot[std::size_t(rows[a])] = -1;
        Z_.valuePtr()[first + a] = -sum[std::size_t(a)];
        own += l[a] * sum[std::size_t(a)];
      }
      diagonal_(j) = own;
    }
  }
  [[nodiscard]] bool valid() const noexcept { return valid_; }
  /// An element of `A^-1`; NaN where the factor has none, infinite if A is not positive definite.
  [[nodiscard]] double operator()(int row, int column) const {
    if (!valid_) return std::numeric_limits<double>::infinity();
    int i = place_(row), j = place_(column);
    if (i == j) return diagonal_(i);
    if (i < j) std::swap(i, j);
    const int *from = Z_.innerIndexPtr() + Z_.outerIndexPtr()[j],
              *to = Z_.innerIndexPtr() + Z_.outerIndexPtr()[j + 1];
    const int* at = std::lower_bound(from, to, i);
    return at != to && *at == i ? Z_.valuePtr()[at - Z_.innerIndexPtr()]
                                : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] Eigen::MatrixXd block(int row, int rows, int column, int columns) const {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&](Eigen::Index i, Eigen::Index j) {
      return (*this)(row + int(i), column + int(j));
    });
  }

 private:
  bool valid_ = false;
  Eigen::VectorXi place_;
  SparseNormal::Matrix Z_;
  Eigen::VectorXd diagonal_;
};

SKINCTL_END_NAMESPACE
