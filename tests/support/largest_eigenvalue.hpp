// The largest eigenvalue of one symmetric matrix against another. Eigen's solver for two matrices takes GCC
// 5 s more.
#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>

namespace skinctl::testing {

using Matrix66 = Eigen::Matrix<double, 6, 6>;

/// The largest l of `a x = l b x`, `b` positive definite: that of `L^-1 a L^-T` with `b = L L^T`.
inline double largest_eigenvalue(Matrix66 a, const Matrix66& b) {
  Matrix66 L = Matrix66::Zero();
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double rest = b(i, j);
      for (int k = 0; k < j; ++k) rest -= L(i, k) * L(j, k);
      L(i, j) = i == j ? std::sqrt(rest) : rest / L(j, j);
    }
  for (int side = 0; side < 2; ++side) {  // L^-1 a, and the same of its transpose
    for (int c = 0; c < 6; ++c)
      for (int i = 0; i < 6; ++i) {
        for (int k = 0; k < i; ++k) a(i, c) -= L(i, k) * a(k, c);
        a(i, c) /= L(i, i);
      }
    a.transposeInPlace();
  }
  return Eigen::SelfAdjointEigenSolver<Matrix66>(a, Eigen::EigenvaluesOnly).eigenvalues()(5);
}

}  // namespace skinctl::testing
