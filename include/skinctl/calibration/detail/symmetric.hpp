// Decompositions of symmetric matrices of any size, for fits at configuration time.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

// Loops over plain numbers: Eigen's decompositions took compilers more than the fits that they serve.

/// Eigenvalues in ascending order, with unit eigenvectors as columns: rotations of Jacobi. NaN where A is not finite.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;

  explicit SymmetricEigen(Eigen::MatrixXd A) {
    const Eigen::Index n = A.rows();
    values = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::quiet_NaN());
    vectors = Eigen::MatrixXd::Identity(n, n);
    if (!A.allFinite()) return;
    double most = 0;
    for (Eigen::Index k = 0; k < n * n; ++k) most = std::max(most, std::abs(A.data()[k]));
    Eigen::MatrixXd V = vectors;
    bool turned = true;
    for (int sweep = 0; turned && sweep < 40; ++sweep) {
      turned = false;
      for (Eigen::Index p = 0; p < n; ++p)
        for (Eigen::Index q = p + 1; q < n; ++q)
          if (std::abs(A(p, q)) > 1e-18 * most) turn(A, V, p, q), turned = true;
    }
    std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), Eigen::Index(0));
    std::sort(order.begin(), order.end(), [&](auto a, auto b) { return A(a, a) < A(b, b); });
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index from = order[std::size_t(k)];
      values(k) = A(from, from);
      for (Eigen::Index i = 0; i < n; ++i) vectors(i, k) = V(i, from);
    }
  }
  [[nodiscard]] double largest() const { return values(values.size() - 1); }

 private:
  // Makes A(p, q) zero.
  static void turn(Eigen::MatrixXd& A, Eigen::MatrixXd& V, Eigen::Index p, Eigen::Index q) noexcept {
    const double theta = (A(q, q) - A(p, p)) / (2 * A(p, q));
    const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
    const double c = 1 / std::sqrt(t * t + 1), s = t * c, moved = t * A(p, q);
    A(p, p) -= moved, A(q, q) += moved, A(p, q) = A(q, p) = 0;
    for (Eigen::Index r = 0; r < A.rows(); ++r) {
      const double v = V(r, p), w = V(r, q);
      V(r, p) = c * v - s * w, V(r, q) = s * v + c * w;
      if (r == p || r == q) continue;
      const double a = A(r, p), b = A(r, q);
      A(r, p) = A(p, r) = c * a - s * b, A(r, q) = A(q, r) = s * a + c * b;
    }
  }
};

/// `A = L L'`. `positive()` is false if A is not positive definite, or not finite; `solve` then means nothing.
class Cholesky {
 public:
  Cholesky() = default;
  explicit Cholesky(const Eigen::MatrixXd& A) { compute(A); }
  void compute(const Eigen::MatrixXd& A) {
    L_ = A;
    const Eigen::Index n = L_.rows();
    positive_ = false;
    for (Eigen::Index j = 0; j < n; ++j) {
      double* own = column(j);
      for (Eigen::Index k = 0; k < j; ++k) {
        const double* other = column(k);
        const double factor = other[j];
        for (Eigen::Index i = j; i < n; ++i) own[i] -= factor * other[i];
      }
      if (!(own[j] > 0 && own[j] < std::numeric_limits<double>::infinity())) return;
      const double root = std::sqrt(own[j]);
      for (Eigen::Index i = j; i < n; ++i) own[i] /= root;
    }
    positive_ = true;
  }
  [[nodiscard]] bool positive() const noexcept { return positive_; }
  /// Where `row >= column`.
  [[nodiscard]] double factor(Eigen::Index row, Eigen::Index column) const { return L_(row, column); }
  [[nodiscard]] Eigen::MatrixXd solve(Eigen::MatrixXd b) const {
    const Eigen::Index n = L_.rows();
    for (Eigen::Index at = 0; at < b.cols(); ++at) {
      double* x = b.data() + at * n;
      for (Eigen::Index j = 0; j < n; ++j) {
        const double* l = column(j);
        x[j] /= l[j];
        for (Eigen::Index i = j + 1; i < n; ++i) x[i] -= x[j] * l[i];
      }
      for (Eigen::Index j = n; j-- > 0;) {
        const double* l = column(j);
        for (Eigen::Index i = j + 1; i < n; ++i) x[j] -= l[i] * x[i];
        x[j] /= l[j];
      }
    }
    return b;
  }
  [[nodiscard]] Eigen::MatrixXd inverse() const {
    return solve(Eigen::MatrixXd::Identity(L_.rows(), L_.rows()));
  }
  /// `log det A`.
  [[nodiscard]] double log_determinant() const {
    double sum = 0;
    for (Eigen::Index i = 0; i < L_.rows(); ++i) sum += 2 * std::log(L_(i, i));
    return sum;
  }
  /// `b' A^-1 b` of a column.
  [[nodiscard]] double squared(const Eigen::MatrixXd& b) const { return b.cwiseProduct(solve(b)).sum(); }

 private:
  [[nodiscard]] double* column(Eigen::Index j) { return L_.data() + j * L_.rows(); }
  [[nodiscard]] const double* column(Eigen::Index j) const { return L_.data() + j * L_.rows(); }

  Eigen::MatrixXd L_;  // above its diagonal, of A
  bool positive_ = false;
};

/// `A^-1 b`, by `A = L D L'` with pivots: also where A is singular, or only almost positive.
[[nodiscard]] inline Eigen::MatrixXd solve_symmetric(Eigen::MatrixXd A, Eigen::MatrixXd b) {
  const Eigen::Index n = A.rows();
  std::vector<Eigen::Index> place(static_cast<std::size_t>(n));  // of a row of A in b
  std::iota(place.begin(), place.end(), Eigen::Index(0));
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < n; ++i)
      if (std::abs(A(i, i)) > std::abs(A(pivot, pivot))) pivot = i;
    std::swap(place[std::size_t(k)], place[std::size_t(pivot)]);
    for (Eigen::Index i = 0; i < n; ++i) std::swap(A(k, i), A(pivot, i));
    for (Eigen::Index i = 0; i < n; ++i) std::swap(A(i, k), A(i, pivot));
    if (!(std::abs(A(k, k)) > std::numeric_limits<double>::min())) continue;
    for (Eigen::Index i = k + 1; i < n; ++i) A(i, k) /= A(k, k);  // row k stays as it was
    for (Eigen::Index j = k + 1; j < n; ++j)
      for (Eigen::Index i = k + 1; i < n; ++i) A(i, j) -= A(i, k) * A(k, j);
  }
  std::vector<double> x(static_cast<std::size_t>(n));
  for (Eigen::Index at = 0; at < b.cols(); ++at) {
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = b(place[k], at);
    for (Eigen::Index k = 0; k < n; ++k)
      for (Eigen::Index i = k + 1; i < n; ++i) x[std::size_t(i)] -= A(i, k) * x[std::size_t(k)];
    for (Eigen::Index k = n; k-- > 0;) {
      double& v = x[std::size_t(k)];
      v = std::abs(A(k, k)) > std::numeric_limits<double>::min() ? v / A(k, k) : 0;
      for (Eigen::Index i = k + 1; i < n; ++i) v -= A(i, k) * x[std::size_t(i)];
    }
    for (std::size_t k = 0; k < x.size(); ++k) b(place[k], at) = x[k];
  }
  return b;
}

/// The shortest of the `x` with which `A x` comes nearest to `b`, A not negative: along what A shows less than `share` of the most,
/// it does not go.
[[nodiscard]] inline Eigen::VectorXd shortest_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                                       double share = 1e-10) {
  const SymmetricEigen eigen(A);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  for (Eigen::Index k = 0; k < b.size(); ++k) {
    if (!(eigen.values(k) > share * eigen.largest())) continue;
    double along = 0;
    for (Eigen::Index i = 0; i < b.size(); ++i) along += eigen.vectors(i, k) * b(i);
    along /= eigen.values(k);
    for (Eigen::Index i = 0; i < b.size(); ++i) x(i) += along * eigen.vectors(i, k);
  }
  return x;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
