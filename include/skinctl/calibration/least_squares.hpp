// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear least squares on manifolds: Levenberg-Marquardt with robust losses.
#pragma once

#include <algorithm>
#include <limits>

#include "skinctl/calibration/fit_end.hpp"
#include "skinctl/calibration/normal_equations.hpp"

SKINCTL_BEGIN_NAMESPACE

struct FitSettings {
  int steps = 50;  ///< largest number of steps, 1 to 10000
  /// Decrease of the cost below which the fit ends, in units of variance: far below what noise does.
  double decrease = 1e-6;
  double first_damping = 1e-4;  ///< damping of the first step, relative to the diagonal of `H`, 1e-12 to 1e6
};

template <class State, class Normal>
struct Fit {
  State state;
  Normal normal;  ///< normal equations at `state` without damping: their inverse is the covariance
  double cost = 0;
  double first_cost = 0;
  int steps = 0;
  FitEnd end = FitEnd::not_finite;

  [[nodiscard]] bool converged() const noexcept { return end == FitEnd::converged; }
};

/// A problem that `least_squares` solves. `terms` calls
/// `sum.add(loss, residual, {{column, derivative}, ...})` for each term; where `Sum::derivatives` is false
/// these may be empty. `plus` moves a state by a tangent vector of `unknowns()`.
template <class P>
concept LeastSquaresProblem =
    requires(const P& p, const typename P::State& x, const Eigen::VectorXd& d, DenseNormal& sum) {
      { p.unknowns() } -> std::convertible_to<int>;
      { p.plus(x, d) } -> std::convertible_to<typename P::State>;
      p.terms(x, sum);
    };

/// Minimises `sum rho(|r|^2) / 2`, rho the loss of each term, from `start`, by Levenberg-Marquardt with
/// Marquardt's scaling and Nielsen's damping. A step that does not lower the cost is not taken, so that the
/// result is never worse than the start. Residuals that are not finite at the start end the fit at once.
///
/// Throws `ConfigurationError` for settings out of range.
///
/// @tparam Normal  `DenseNormal` or `SparseNormal`.
template <class Normal = DenseNormal, LeastSquaresProblem P>
[[nodiscard]] Fit<typename P::State, Normal> least_squares(const P& problem, typename P::State start,
                                                           const FitSettings& settings = {}) {
  require(settings.steps >= 1 && settings.steps <= 10000, "fit: steps", settings.steps, "1 to 10000");
  require(settings.first_damping >= 1e-12 && settings.first_damping <= 1e6, "fit: first_damping",
          settings.first_damping, "1e-12 to 1e6");
  require(settings.decrease > 0, "fit: decrease", settings.decrease, "> 0");
  Fit<typename P::State, Normal> fit{std::move(start), {}};
  const int n = problem.unknowns();
  const auto sum_up = [&] {
    fit.normal.start(n);
    problem.terms(fit.state, fit.normal);
    fit.cost = fit.normal.cost();
  };
  sum_up();
  fit.first_cost = fit.cost;
  if (!(fit.cost < std::numeric_limits<double>::infinity()) || !fit.normal.gradient().allFinite()) return fit;
  double damping = settings.first_damping, growth = 2;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
  CostOnly trial;
  fit.end = FitEnd::steps_used;
  int refused = 0;
  while (fit.steps < settings.steps) {
    const Eigen::VectorXd diagonal = fit.normal.diagonal();
    // What no term names gets damping all the same, and then stays where it is.
    const double least = std::max(1e-12 * (n > 0 ? diagonal.maxCoeff() : 0), 1e-30);
    Eigen::VectorXd D = diagonal;
    for (double& d : D) d = damping * std::max(d, least);
    double predicted = -1;
    if (fit.normal.solve(D, step)) {
      predicted = 0;
      for (int k = 0; k < n; ++k) predicted += 0.5 * step(k) * (D(k) * step(k) - fit.normal.gradient()(k));
    }
    if (predicted >= 0 && predicted <= settings.decrease && damping <= 1) {
      fit.end = FitEnd::converged;
      break;
    }
    double cost = std::numeric_limits<double>::infinity();
    if (predicted >= 0) {
      auto state = problem.plus(fit.state, step);
      trial.start(n);
      problem.terms(state, trial);
      cost = trial.cost();
      if (cost < fit.cost) {
        const double gain = (fit.cost - cost) / predicted, below = 2 * gain - 1;
        fit.state = std::move(state);
        sum_up();
        ++fit.steps;
        refused = 0;
        damping = std::max(1e-12, damping * std::max(1.0 / 3, 1 - below * below * below));
        growth = 2;
        continue;
      }
    }
    // Rounding: the cost cannot tell the two apart.
    if (predicted >= 0 && cost < fit.cost * (1 + 1e-12) && predicted < 1e-10 * fit.cost) {
      fit.end = FitEnd::converged;
      break;
    }
    if (++refused > 30) {
      fit.end = FitEnd::stuck;
      break;
    }
    damping = std::min(1e30, damping * growth);
    growth *= 2;
  }
  return fit;
}

SKINCTL_END_NAMESPACE
