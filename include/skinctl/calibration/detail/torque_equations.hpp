// SPDX-License-Identifier: BSD-3-Clause
// The normal equations of joint torques in masses, friction and rotors.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "skinctl/calibration/base_parameters.hpp"
#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/joint_motion.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Positions and torques of the joints.
struct TorqueRecording {
  JointRecording joints;
  Eigen::MatrixXd torque;  ///< a row per stamp of `joints`, a column per joint [N m]
};

namespace detail::fit {

/// The normal equations of all joints. Columns of a joint: regressor (10 N), dq, z, ddq; without the means of
/// each recording.
template <RobotModel M>
class TorqueEquations {
 public:
  static constexpr std::size_t N = M::joints;
  static constexpr Eigen::Index n = Eigen::Index(N), bodies = 10 * n, all = bodies + 3 * n;

  /// @param late  by how much torques come later than positions [s].
  TorqueEquations(const M& model, const std::vector<TorqueRecording>& recordings, double late) {
    require(!recordings.empty(), "recordings of torques", 0, ">= 1");
    presliding_.fill(1.4e-3);
    noise_.fill(1), alike_.fill(1);
    Eigen::Index rows = 0;
    std::vector<MeasuredMotion> motions;
    for (const auto& r : recordings) {
      require(r.joints.q.cols() == n, "joints of a recording", double(r.joints.q.cols()),
              "those of the model");
      require(r.torque.rows() == r.joints.q.rows() && r.torque.cols() == n, "rows of torques",
              double(r.torque.rows()), "one per stamp, a column per joint");
      require(r.torque.allFinite(), "torques that are not finite", 1, "none");
      motions.emplace_back(r.joints);
      Eigen::Index first = rows;
      for (std::size_t k = 0; k < r.joints.time.size(); ++k)
        rows += usable(motions.back(), r.joints.time[k] - late);
      require(rows - first >= 200, "torques of a recording", double(rows - first), ">= 200");
      spans_.push_back({first, rows - first});
    }
    for (std::size_t j = 0; j < N; ++j) A_[j].setZero(rows, bodies + 3), tau_[j].resize(rows);
    q_.resize(rows, n);
    Eigen::Index row = 0;
    for (std::size_t r = 0; r < recordings.size(); ++r)
      for (std::size_t k = 0; k < recordings[r].joints.time.size(); ++k) {
        const double t = recordings[r].joints.time[k] - late;
        if (!usable(motions[r], t)) continue;
        const JointPoint p = motions[r].at(t);
        JointPosition<N> q;
        JointVelocity<N> dq;
        JointAcceleration<N> ddq;
        for (std::size_t i = 0; i < N; ++i)
          q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
        const auto Y = as_eigen(regressor(model, q, dq, dq, ddq));
        q_.row(row) = p.q.transpose();
        for (std::size_t j = 0; j < N; ++j) {
          const auto i = Eigen::Index(j);
          A_[j].row(row).head(bodies) = Y.row(i);
          A_[j](row, bodies) = p.dq(i), A_[j](row, bodies + 2) = p.ddq(i);
          tau_[j](row) = recordings[r].torque(Eigen::Index(k), i);
        }
        ++row;
      }
    for (std::size_t j = 0; j < N; ++j) {
      const double way = q_.col(Eigen::Index(j)).maxCoeff() - q_.col(Eigen::Index(j)).minCoeff();
      require(way > 0.02, "way of a joint in all recordings", way,
              "> 0.02 rad: its friction is not known otherwise");
      friction(j, presliding_[j], A_[j].col(bodies + 1));
      for (Eigen::Index c = 0; c < A_[j].cols(); ++c) centre(A_[j].col(c));
      centre(tau_[j]);
      square_[j] = A_[j].transpose() * A_[j];
    }
  }

  /// Sets the variance and the correlation in time of the residuals by parameters `x`; they weight the
  /// equations.
  void refine(const Eigen::VectorXd& x) {
    for (std::size_t j = 0; j < N; ++j) {
      const Eigen::VectorXd e = residual(j, x);
      const double square = std::max(e.squaredNorm(), 1e-18);
      noise_[j] = std::sqrt(square / double(e.size()));
      explained_[j] = 1 - square / std::max(tau_[j].squaredNorm(), 1e-18);
      double sum = 1;  // 1 + 2 sum of correlations, to the first that is not positive
      for (Eigen::Index lag = 1; lag < std::min<Eigen::Index>(400, e.size() / 4); ++lag) {
        const double c = e.head(e.size() - lag).dot(e.tail(e.size() - lag)) / square;
        if (c <= 0) break;
        sum += 2 * c;
      }
      alike_[j] = sum;
    }
  }
  [[nodiscard]] Eigen::MatrixXd H() const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(all, all);
    for (std::size_t j = 0; j < N; ++j) {
      const double w = weight(j);
      const Eigen::MatrixXd G = w * square_[j];
      const auto at = [&](Eigen::Index k) { return index(j, k); };
      out.topLeftCorner(bodies, bodies) += G.topLeftCorner(bodies, bodies);
      for (Eigen::Index a = 0; a < 3; ++a) {
        out.row(at(a)).head(bodies) += G.row(bodies + a).head(bodies);
        out.col(at(a)).head(bodies) += G.col(bodies + a).head(bodies);
        for (Eigen::Index b = 0; b < 3; ++b) out(at(a), at(b)) += G(bodies + a, bodies + b);
      }
    }
    return out;
  }
  [[nodiscard]] Eigen::VectorXd b() const {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(all);
    for (std::size_t j = 0; j < N; ++j) {
      const Eigen::VectorXd g = weight(j) * (A_[j].transpose() * tau_[j]);
      out.head(bodies) += g.head(bodies);
      for (Eigen::Index a = 0; a < 3; ++a) out(index(j, a)) += g(bodies + a);
    }
    return out;
  }
  /// Ordinary least squares in the base parameters, friction and rotors. Rotors whose torques are those of
  /// their links, a UR5's first two, make these equations singular: the sum of both is found.
  [[nodiscard]] Eigen::VectorXd least_squares(const BaseParameters& base, bool rotors) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(all);
    std::vector<Eigen::Index> columns(base.columns.begin(), base.columns.end());
    for (Eigen::Index k = bodies; k < all; ++k)
      if (k < bodies + 2 * n || (rotors && k > bodies + 2 * n)) columns.push_back(k);
    const auto m = Eigen::Index(columns.size());
    for (int round = 0; round < 2; ++round) {
      const Eigen::MatrixXd full = H();
      const Eigen::VectorXd right = b();
      Eigen::MatrixXd A(m, m);
      Eigen::VectorXd g(m);
      for (Eigen::Index i = 0; i < m; ++i) {
        g(i) = right(columns[std::size_t(i)]);
        for (Eigen::Index k = 0; k < m; ++k) A(i, k) = full(columns[std::size_t(i)], columns[std::size_t(k)]);
      }
      const Eigen::VectorXd scale = A.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
      for (Eigen::Index i = 0; i < m; ++i) {
        g(i) *= scale(i);
        for (Eigen::Index k = 0; k < m; ++k) A(i, k) *= scale(i) * scale(k);
      }
      const Eigen::VectorXd solved = shortest_solution(A, g);
      for (Eigen::Index i = 0; i < m; ++i) x(columns[std::size_t(i)]) = scale(i) * solved(i);
      refine(x);
    }
    return x;
  }
  /// Variance of the torques that parameters `x` leave, as a share of all: 1 - R^2, the sum over the joints.
  /// @param presliding  presliding distance x0 of each joint [rad], of the fit that found `x`.
  [[nodiscard]] double unexplained(const Eigen::VectorXd& x, const std::array<double, N>& presliding) {
    double sum = 0;
    for (std::size_t j = 0; j < N; ++j) {
      friction(j, presliding[j], A_[j].col(bodies + 1));
      centre(A_[j].col(bodies + 1));
      sum += residual(j, x).squaredNorm() / std::max(tau_[j].squaredNorm(), 1e-18);
    }
    return sum;
  }
  /// Sets each joint's presliding distance, 0.02 to 0.2 degrees, to that with the smallest residuals.
  void set_presliding(const Eigen::VectorXd& x) {
    for (std::size_t j = 0; j < N; ++j) {
      const Eigen::VectorXd rest = residual(j, x) + A_[j].col(bodies + 1) * x(index(j, 1));
      Eigen::VectorXd z(rest.size()), best;
      double least = 1e300;
      for (double degrees = 0.02; degrees < 0.205; degrees += 0.01) {
        friction(j, degrees * 0.0174532925, z);
        centre(z);
        const double square = z.squaredNorm();
        if (square < 1e-12) continue;
        const double left = rest.squaredNorm() - std::pow(z.dot(rest), 2) / square;
        if (left < least) least = left, best = z, presliding_[j] = degrees * 0.0174532925;
      }
      if (best.size() == 0) continue;
      A_[j].col(bodies + 1) = best;
      square_[j] = A_[j].transpose() * A_[j];
    }
  }

  [[nodiscard]] const std::array<double, N>& presliding() const noexcept { return presliding_; }
  [[nodiscard]] const std::array<double, N>& noise() const noexcept { return noise_; }
  [[nodiscard]] const std::array<double, N>& explained() const noexcept { return explained_; }

 private:
  struct Span {
    Eigen::Index first, size;
  };
  [[nodiscard]] static bool usable(const MeasuredMotion& motion, double t) {
    return t > motion.start() && t < motion.end() && !motion.gap_within(t - 0.1, t + 0.1);
  }
  [[nodiscard]] static Eigen::Index index(std::size_t joint, Eigen::Index term) noexcept {
    return bodies + term * n + Eigen::Index(joint);
  }
  [[nodiscard]] double weight(std::size_t j) const noexcept {
    return 1 / (noise_[j] * noise_[j] * alike_[j]);
  }
  template <class Column>
  void centre(Column&& column) const {
    for (const Span& s : spans_) {
      const double mean = column.segment(s.first, s.size).mean();
      column.segment(s.first, s.size).array() -= mean;
    }
  }
  template <class Column>
  void friction(std::size_t joint, double x0, Column&& z) const {
    for (const Span& s : spans_) {
      double now = 0, last = q_(s.first, Eigen::Index(joint));
      for (Eigen::Index k = s.first; k < s.first + s.size; ++k) {
        const double step = q_(k, Eigen::Index(joint)) - last, side = step > 0 ? 1 : -1;
        last += step;
        now = side - (side - now) * std::exp(-std::abs(step) / x0);
        z(k) = now;
      }
    }
  }
  [[nodiscard]] Eigen::VectorXd residual(std::size_t j, const Eigen::VectorXd& x) const {
    return tau_[j] - A_[j].leftCols(bodies) * x.head(bodies) - A_[j].col(bodies) * x(index(j, 0)) -
           A_[j].col(bodies + 1) * x(index(j, 1)) - A_[j].col(bodies + 2) * x(index(j, 2));
  }

  std::array<Eigen::MatrixXd, N> A_, square_;  ///< rows A of each joint, and A'A
  std::array<Eigen::VectorXd, N> tau_;
  Eigen::MatrixXd q_;
  std::vector<Span> spans_;
  std::array<double, N> presliding_{}, noise_{}, alike_{}, explained_{};
};

}  // namespace detail::fit
SKINCTL_END_NAMESPACE
