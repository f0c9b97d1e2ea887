// The motion that shows a robot's masses: Fourier series, chosen at random for the regressor's determinant.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "skinctl/calibration/base_parameters.hpp"
#include "skinctl/calibration/excitation.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A periodic motion about home for `fit_inertia`: five harmonics a joint, chosen among random ones for the largest
/// `log det` of the weighted base regressor, within the limits of positions, velocities, accelerations and torques.
class DynamicsExcitation : public Excitation {
 public:
  struct Settings {
    double period = 10;  ///< [s], 2 to 60; 20 s move a UR5 too slowly
    int periods = 3;     ///< 1 to 100
    double range = 1.5;  ///< at most, from home [rad], 0.05 to 3
    double share = 0.9;  ///< of each limit that may be used, 0.1 to 1
    int tries = 150;     ///< motions that are compared, 1 to 100000
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
      // Later ones are near the best.
      const double mix = k < s.tries / 2 || kept.empty() ? 1 : 0.3;
      draw(rng, limits, s, kept, mix);
      const double value = information(model, limits, s, base);
      if (value > best) best = value, kept = parts_;
    }
    require(!kept.empty(), "motions within the torque limits", 0, ">= 1: choose another home or less range");
    parts_ = kept;
    information_ = best;
    announce(0, duration_, -1);
  }
  template <RobotModel M>
  DynamicsExcitation(const M& model, const Eigen::VectorXd& home, const ExcitationLimits& limits)
      : DynamicsExcitation(model, home, limits, Settings{}) {}

  /// `log det` of the base regressor, in torque limits.
  [[nodiscard]] double information() const noexcept { return information_; }

 private:
  double information_ = 0;

  void draw(std::mt19937_64& rng, const ExcitationLimits& limits, const Settings& s,
            const std::vector<std::vector<detail::fit::RisingSines>>& near, double mix) {
    const auto random = [&] { return double(rng() >> 11) * 0x1p-52 - 1; };
    parts_.assign(std::size_t(home_.size()), {});
    for (Eigen::Index j = 0; j < home_.size(); ++j) {
      detail::fit::RisingSines f{0, duration_, std::min(1.0, s.period / 4), {}, {}, {}};
      for (int k = 1; k <= 5; ++k) {
        const double rate = 6.283185307179586 * k / s.period, size = 1 / std::sqrt(double(k));
        f.rate.push_back(rate), f.sine.push_back(size * random()), f.cosine.push_back(size * random());
      }
      const double room =
          s.share * std::min({s.range, home_(j) - limits.lower(j), limits.upper(j) - home_(j)});
      if (mix < 1)
        for (std::size_t k = 0; k < 5; ++k) {
          f.sine[k] = near[std::size_t(j)][0].sine[k] + mix * room * 0.3 * f.sine[k];
          f.cosine[k] = near[std::size_t(j)][0].cosine[k] + mix * room * 0.3 * f.cosine[k];
        }
      double x = 0, v = 0, a = 0;
      for (double t = 0; t <= duration_; t += 0.01) {
        const auto p = f.at(t);
        x = std::max(x, std::abs(p.x)), v = std::max(v, std::abs(p.v)), a = std::max(a, std::abs(p.a));
      }
      const double scale =
          std::min({room / x, s.share * limits.velocity(j) / v, s.share * limits.acceleration(j) / a});
      for (std::size_t k = 0; k < 5; ++k) f.sine[k] *= scale, f.cosine[k] *= scale;
      parts_[std::size_t(j)].push_back(f);
    }
  }
  /// -1e300 for a motion beyond the torque limits.
  template <RobotModel M>
  [[nodiscard]] double information(const M& model, const ExcitationLimits& limits, const Settings& s,
                                   const BaseParameters& base) const {
    constexpr std::size_t N = M::joints;
    const auto m = Eigen::Index(base.columns.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(m, m) * 1e-9;
    const auto theta = inertial_parameters(model);
    for (int k = 0; k < 60; ++k) {
      const JointPoint p = at(2 + s.period * k / 60.0);
      JointPosition<N> q;
      JointVelocity<N> dq;
      JointAcceleration<N> ddq;
      for (std::size_t i = 0; i < N; ++i)
        q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
      const auto regress = regressor(model, q, dq, dq, ddq);
      const auto tau = regress * theta;
      const auto Y = as_eigen(regress);
      Eigen::MatrixXd rows(Eigen::Index(N), m);
      for (Eigen::Index i = 0; i < Eigen::Index(N); ++i) {
        if (std::abs(tau[std::size_t(i)]) > s.share * limits.torque(i)) return -1e300;
        for (Eigen::Index c = 0; c < m; ++c)
          rows(i, c) = Y(i, base.columns[std::size_t(c)]) / limits.torque(i);
      }
      A.noalias() += rows.transpose() * rows;
    }
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(A);
    return ldlt.vectorD().array().max(1e-300).log().sum();
  }
};

SKINCTL_END_NAMESPACE
