// SPDX-License-Identifier: BSD-3-Clause
// Bodies and friction that fit normal equations best: Newton's method inside what bodies can be.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/pseudo_inertia.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::fit {

/// Newton's method for the minimum of
/// ```
/// 1/2 x'Hx - b'x + w sum_bodies (tr(P0^-1 P) - log det P) - 1/2 sum_scalars log s
/// ```
/// of bodies, ten numbers each, and of scalars behind them that are positive (friction, rotors). P is linear
/// in x: the function is convex, and its one minimum is inside. The last term keeps a scalar that nothing
/// shows about one deviation away from 0.
class InertialNewton {
 public:
  /// @param H, b      over all unknowns.
  /// @param prior     bodies of the divergence, P0.
  /// @param w         weight of the divergence, > 0.
  /// @param absent    scalars from here on are not there: they stay 0.
  InertialNewton(Eigen::MatrixXd H, Eigen::VectorXd b, const std::vector<Inertia10>& prior, double w,
                 Eigen::Index absent)
      : H_(std::move(H)), b_(std::move(b)), w_(w), bodies_(10 * Eigen::Index(prior.size())), end_(absent) {
    for (int k = 0; k < 10; ++k) one_[std::size_t(k)] = pseudo_inertia(Inertia10::Unit(k));
    toward_ = Eigen::VectorXd::Zero(b_.size());
    for (std::size_t i = 0; i < prior.size(); ++i) {
      const Eigen::MatrixXd inverse = Cholesky(pseudo_inertia(prior[i])).inverse();
      for (int k = 0; k < 10; ++k)
        toward_(10 * Eigen::Index(i) + k) = -w * inverse.cwiseProduct(one_[std::size_t(k)]).sum();
    }
  }

  struct Result {
    int steps = 0;
    bool converged = false;
  };
  /// Moves `x`, which is inside, to the minimum, within 1e-6 of its value, in at most `most` steps. Begins
  /// with much more weight on the terms that keep `x` inside, a tenth of it at a time: steps along an edge
  /// would be short.
  Result minimise(Eigen::VectorXd& x, int most) const {
    Result out;
    Eigen::VectorXd d;
    double more = std::max(1.0, newton(x, 1, d));
    while (out.steps < most) {
      const double gain = newton(x, more, d), now = value(x, more);
      ++out.steps;
      if (more > 1 && gain < 0.1 * more * std::min(w_, 0.5)) {  // within a full step of that minimum
        more = std::max(1.0, 0.1 * more);
        continue;
      }
      out.converged = gain < 1e-6;
      if (out.converged) break;
      Eigen::VectorXd there = x;
      double share = 1;
      const auto better = [&] {
        there.head(end_) = x.head(end_) + share * d;
        return inside(there) && value(there, more) < now - 0.1 * share * gain;
      };
      while (share > 1e-12 && !better()) share *= 0.5;
      if (share <= 1e-12) {  // no smaller value can be told from this one
        out.converged = more == 1 && gain < 1e-12 * std::abs(now);
        break;
      }
      x = there;
    }
    return out;
  }

 private:
  // The Newton step `d` with `more` weight on what keeps x inside, and what it promises to gain.
  double newton(const Eigen::VectorXd& x, double more, Eigen::VectorXd& d) const {
    Eigen::MatrixXd A = H_.topLeftCorner(end_, end_);
    const Eigen::VectorXd Hx = H_ * x;
    Eigen::VectorXd g = b_.head(end_) - Hx.head(end_) + more * toward_.head(end_);
    for (Eigen::Index at = 0; at < bodies_; at += 10) {
      const Eigen::MatrixXd inverse = Cholesky(pseudo_inertia(x.segment<10>(at))).inverse();
      std::array<Eigen::MatrixXd, 10> turned;
      for (std::size_t k = 0; k < 10; ++k) {
        turned[k] = inverse * one_[k];
        g(at + Eigen::Index(k)) += more * w_ * turned[k].trace();
      }
      for (std::size_t k = 0; k < 10; ++k)
        for (std::size_t l = 0; l < 10; ++l)
          A(at + Eigen::Index(k), at + Eigen::Index(l)) +=
              more * w_ * turned[k].cwiseProduct(turned[l].transpose()).sum();
    }
    for (Eigen::Index i = bodies_; i < end_; ++i)
      g(i) += 0.5 * more / x(i), A(i, i) += 0.5 * more / (x(i) * x(i));
    const Eigen::VectorXd scale = A.diagonal().cwiseSqrt().cwiseInverse();
    A = scale.asDiagonal() * A * scale.asDiagonal();
    const Eigen::VectorXd scaled = scale.cwiseProduct(g);
    d = scale.cwiseProduct(Eigen::VectorXd(solve_symmetric(A, scaled)));
    return 0.5 * g.dot(d);
  }
  [[nodiscard]] bool inside(const Eigen::VectorXd& x) const {
    for (Eigen::Index i = bodies_; i < end_; ++i)
      if (!(x(i) > 0)) return false;
    for (Eigen::Index at = 0; at < bodies_; at += 10)
      if (!Cholesky(pseudo_inertia(x.segment<10>(at))).positive()) return false;
    return true;
  }
  [[nodiscard]] double value(const Eigen::VectorXd& x, double more) const {
    const Eigen::VectorXd Hx = H_ * x;
    double sum = 0.5 * x.dot(Hx) - b_.dot(x) - more * toward_.dot(x);
    for (Eigen::Index at = 0; at < bodies_; at += 10)
      sum -= more * w_ * Cholesky(pseudo_inertia(x.segment<10>(at))).log_determinant();
    for (Eigen::Index i = bodies_; i < end_; ++i) sum -= 0.5 * more * std::log(x(i));
    return sum;
  }

  Eigen::MatrixXd H_;
  Eigen::VectorXd b_, toward_;
  double w_;
  Eigen::Index bodies_, end_;
  std::array<Eigen::MatrixXd, 10> one_;
};

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
