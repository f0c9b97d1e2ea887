// Whether the derivatives of a fit belong to its residuals.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "skinctl/calibration/normal_equations.hpp"

namespace skinctl::testing {

/// The residuals of a problem's terms and their derivatives, as one matrix.
class JacobianOf {
 public:
  static constexpr bool derivatives = true;
  explicit JacobianOf(int unknowns) : unknowns_(unknowns) {}
  void add(const Loss& /*loss*/, const Columns& r, Partials by = {}) {
    const auto at = residual.size();
    residual.conservativeResize(at + r.rows);
    jacobian.conservativeResize(at + r.rows, unknowns_);
    for (int i = 0; i < r.rows; ++i) {
      residual(at + i) = r.data[i];
      for (int k = 0; k < unknowns_; ++k) jacobian(at + i, k) = 0;
      for (const Partial& b : by)
        for (int k = 0; k < b.matrix.cols && b.column >= 0; ++k)
          jacobian(at + i, b.column + k) += b.matrix.column(k)[i];
    }
  }
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;

 private:
  int unknowns_;
};

/// The largest difference between the derivatives that `problem` gives at `x` and central differences,
/// relative to the largest derivative of the same unknown.
template <class P>
[[nodiscard]] double worst_derivative(const P& problem, const typename P::State& x, double h = 1e-6) {
  const int n = problem.unknowns();
  JacobianOf at(n);
  problem.terms(x, at);
  double worst = 0;
  for (int k = 0; k < n; ++k) {
    Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
    JacobianOf forward(n), backward(n);
    d(k) = h;
    problem.terms(problem.plus(x, d), forward);
    d(k) = -h;
    problem.terms(problem.plus(x, d), backward);
    const Eigen::VectorXd slope = (forward.residual - backward.residual) / (2 * h);
    const double size = std::max(1e-9, slope.cwiseAbs().maxCoeff());
    worst = std::max(worst, (slope - at.jacobian.col(k)).cwiseAbs().maxCoeff() / size);
  }
  return worst;
}

}  // namespace skinctl::testing
