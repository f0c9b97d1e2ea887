// SPDX-License-Identifier: BSD-3-Clause
// The motion that shows a robot's masses: sums of sines, sought at random for the regressor's determinant.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "skinctl/calibration/base_parameters.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/excitation.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A motion about home for `fit_inertia`: seven sines a joint, sought at random for the largest `log det` of
/// the normal matrix of base parameters, viscous friction and rotors, torques in units of their limits;
/// within the limits of positions, velocities, accelerations and torques.
///
/// Frequencies are unlike each other: a motion that repeats itself says the same of a gear's ripple in every
/// period.
class DynamicsExcitation : public Excitation {
 public:
  struct Settings {
    double period = 10;  ///< approximate period of the slowest sine [s], 2 to 60; 20 s move a UR5 too slowly
    int periods = 3;     ///< duration in periods, 1 to 100
    double range = 1.5;  ///< largest distance of a joint from home [rad], 0.05 to 3
    double share = 0.9;  ///< share of each limit that may be used, 0.1 to 1
    int tries = 150;     ///< number of motions that are compared, 1 to 100000
    std::uint64_t seed = 1;
  };
  /// Throws `ConfigurationError` for numbers out of their range, and if no motion keeps the limits of torque.
  template <RobotModel M>
  DynamicsExcitation(const M& model, const Eigen::VectorXd& home, const ExcitationLimits& limits,
                     const Settings& s) {
    constexpr std::size_t N = M::joints;
    check(home, limits);
    require(home.size() == Eigen::Index(N), "joints", double(home.size()), "as many as of the model");
    require(s.period >= 2 && s.period <= 60, "period", s.period, "2 to 60 s");
    require(s.periods >= 1 && s.periods <= 100, "periods", s.periods, "1 to 100");
    require(s.range >= 0.05 && s.range <= 3, "range", s.range, "0.05 to 3 rad");
    require(s.share >= 0.1 && s.share <= 1, "share of the limits", s.share, "0.1 to 1");
    require(s.tries >= 1 && s.tries <= 100000, "tries", s.tries, "1 to 100000");
    require(limits.torque.size() == home.size(), "torque limits", double(limits.torque.size()),
            "one per joint");
    home_ = home, duration_ = s.period * s.periods;
    const BaseParameters base = base_parameters(model);
    std::mt19937_64 rng(s.seed);
    double best = -1e300;
    std::vector<std::vector<detail::fit::RisingSines>> kept;
    for (int k = 0; k < s.tries; ++k) {
      // The first are drawn anew; later ones change one joint of the best, less and less.
      if (4 * k < s.tries || kept.empty()) {
        parts_.assign(std::size_t(home_.size()), {});
        for (Eigen::Index j = 0; j < home_.size(); ++j) parts_[std::size_t(j)] = {draw(rng, j, limits, s)};
      } else {
        parts_ = kept;
        const auto j = Eigen::Index(rng() % N);
        change(rng, parts_[std::size_t(j)][0], 1.0 - double(k) / double(s.tries));
        scale(parts_[std::size_t(j)][0], j, limits, s);
      }
      const double value = information(model, limits, s, base);
      if (value > best && torque_share(model, limits.torque) <= s.share) best = value, kept = parts_;
    }
    require(!kept.empty(), "motions within the torque limits", 0, ">= 1: choose another home or less range");
    parts_ = kept;
    information_ = best;
    announce(0, duration_, all_joints);
  }
  template <RobotModel M>
  DynamicsExcitation(const M& model, const Eigen::VectorXd& home, const ExcitationLimits& limits)
      : DynamicsExcitation(model, home, limits, Settings{}) {}

  /// `log det` of the normal matrix of the motion, torques in units of their limits.
  [[nodiscard]] double information() const noexcept { return information_; }

 private:
  double information_ = 0;

  [[nodiscard]] static double random(std::mt19937_64& rng) { return double(rng() >> 11) * 0x1p-52 - 1; }

  // Five slow sines for gravity, each about a harmonic of the period, and two fast ones for inertia. No two
  // joints share a frequency, and the motion does not repeat itself within its duration: what torques have of
  // positions, such as the ripple of a gear, is then not the same in every period.
  detail::fit::RisingSines draw(std::mt19937_64& rng, Eigen::Index joint, const ExcitationLimits& limits,
                                const Settings& s) const {
    detail::fit::RisingSines f{0, duration_, std::min(1.0, s.period / 4), {}, {}, {}};
    for (int k = 1; k <= 7; ++k) {
      const double hertz = k <= 5 ? (k + 0.4 * random(rng)) / s.period
                                  : (k == 6 ? 10 : 16) / s.period * (1 + 0.2 * random(rng));
      f.rate.push_back(6.283185307179586 * hertz);
      f.sine.push_back(random(rng) / std::sqrt(hertz)), f.cosine.push_back(random(rng) / std::sqrt(hertz));
      if (k > 5) f.sine.back() *= 0.5, f.cosine.back() *= 0.5;
    }
    scale(f, joint, limits, s);
    return f;
  }
  static void change(std::mt19937_64& rng, detail::fit::RisingSines& f, double size) {
    for (std::size_t k = 0; k < f.rate.size(); ++k) {
      double most = 0;
      for (std::size_t l = 0; l < f.rate.size(); ++l)
        most = std::max({most, std::abs(f.sine[l] * f.rate[l]), std::abs(f.cosine[l] * f.rate[l])});
      f.sine[k] += size * most / f.rate[k] * random(rng),
          f.cosine[k] += size * most / f.rate[k] * random(rng);
      f.rate[k] *= 1 + 0.05 * size * random(rng);
    }
  }
  // As large as the limits allow.
  void scale(detail::fit::RisingSines& f, Eigen::Index j, const ExcitationLimits& limits,
             const Settings& s) const {
    const double room = s.share * std::min({s.range, home_(j) - limits.lower(j), limits.upper(j) - home_(j)});
    double x = 1e-9, v = 1e-9, a = 1e-9;
    for (double t = 0; t <= duration_; t += 0.01) {
      const auto p = f.at(t);
      x = std::max(x, std::abs(p.x)), v = std::max(v, std::abs(p.v)), a = std::max(a, std::abs(p.a));
    }
    const double most =
        std::min({room / x, s.share * limits.velocity(j) / v, s.share * limits.acceleration(j) / a});
    for (std::size_t k = 0; k < f.rate.size(); ++k) f.sine[k] *= most, f.cosine[k] *= most;
  }
  /// `log det` of the normal matrix; -1e300 for a motion beyond the torque limits.
  template <RobotModel M>
  [[nodiscard]] double information(const M& model, const ExcitationLimits& limits, const Settings& s,
                                   const BaseParameters& base) const {
    constexpr std::size_t N = M::joints;
    const auto m = Eigen::Index(base.columns.size()), n = Eigen::Index(N);
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(m + 2 * n, m + 2 * n) * 1e-9;
    const auto theta = inertial_parameters(model);
    const int points = 60 * std::min(s.periods, 3);
    for (int k = 0; k < points; ++k) {
      const JointPoint p = at(1 + (duration_ - 2) * k / points);
      JointPosition<N> q;
      JointVelocity<N> dq;
      JointAcceleration<N> ddq;
      for (std::size_t i = 0; i < N; ++i)
        q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
      const auto regress = regressor(model, q, dq, dq, ddq);
      const auto tau = regress * theta;
      const auto Y = as_eigen(regress);
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, m + 2 * n);
      for (Eigen::Index i = 0; i < Eigen::Index(N); ++i) {
        if (std::abs(tau[std::size_t(i)]) > s.share * limits.torque(i)) return -1e300;
        for (Eigen::Index c = 0; c < m; ++c)
          rows(i, c) = Y(i, base.columns[std::size_t(c)]) / limits.torque(i);
        rows(i, m + i) = p.dq(i) / limits.torque(i), rows(i, m + n + i) = p.ddq(i) / limits.torque(i);
      }
      A.noalias() += rows.transpose() * rows;
    }
    const detail::Cholesky factor(A);
    return factor.positive() ? factor.log_determinant() : -1e300;
  }
};

SKINCTL_END_NAMESPACE
