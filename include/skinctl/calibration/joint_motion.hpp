// SPDX-License-Identifier: BSD-3-Clause
// The motion of joints from their encoders: positions, velocities and accelerations at any time.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/joint_recording.hpp"
#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail::fit {

/// The six quintic B-splines of a knot interval at `u`, 0 to 1 within it, and their derivatives by u.
struct QuinticBasis {
  double value[6], slope[6], bend[6];

  explicit QuinticBasis(double u) noexcept {
    static constexpr double c[6][6] = {{1, -5, 10, -10, 5, -1},  {26, -50, 20, 20, -20, 5},
                                       {66, 0, -60, 0, 30, -10}, {26, 50, 20, -20, -20, 10},
                                       {1, 5, 10, 10, 5, -5},    {0, 0, 0, 0, 0, 1}};
    for (int i = 0; i < 6; ++i) {
      const double* a = c[i];
      value[i] = (a[0] + u * (a[1] + u * (a[2] + u * (a[3] + u * (a[4] + u * a[5]))))) / 120;
      slope[i] = (a[1] + u * (2 * a[2] + u * (3 * a[3] + u * (4 * a[4] + u * 5 * a[5])))) / 120;
      bend[i] = (2 * a[2] + u * (6 * a[3] + u * (12 * a[4] + u * 20 * a[5]))) / 120;
    }
  }
};

/// Solves `A X = B` in place; `A` is symmetric and positive definite, given by its diagonals: `A(i, i - k)`
/// at `band(k, i)`.
inline void solve_banded(Eigen::MatrixXd& band, Eigen::MatrixXd& B) {
  const Eigen::Index n = band.cols(), width = band.rows() - 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = std::min(width, i); k >= 0; --k) {
      double sum = band(k, i);
      const Eigen::Index j = i - k;
      for (Eigen::Index m = std::max<Eigen::Index>(0, i - width); m < j; ++m)
        if (j - m <= width) sum -= band(i - m, i) * band(j - m, j);
      band(k, i) = k == 0 ? std::sqrt(sum) : sum / band(0, j);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 1; k <= std::min(width, i); ++k) B.row(i) -= band(k, i) * B.row(i - k);
    B.row(i) /= band(0, i);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = 1; k <= width && i + k < n; ++k) B.row(i) -= band(k, i + k) * B.row(i + k);
    B.row(i) /= band(0, i);
  }
}

}  // namespace detail::fit

/// A quintic B-spline through positions of joints, by least squares. With knots every 60 ms, encoders of 125
/// Hz and 1e-5 rad the acceleration is good to 0.02 rad/s^2.
class MeasuredMotion {
 public:
  /// A time without measurements that is longer than two knots; the motion in it is a guess.
  struct Gap {
    double from = 0, to = 0;  ///< begin and end [s]
  };

  /// Throws `ConfigurationError` for less than 30 positions, stamps that do not increase, numbers that are
  /// not finite, `knot` out of 0.01 to 1 s, and recordings beyond a day.
  explicit MeasuredMotion(const JointRecording& recording, double knot = 0.06) : knot_(knot) {
    const auto& [time, q] = recording;
    require(time.size() >= 30, "positions of joints", double(time.size()), ">= 30");
    require(q.rows() == Eigen::Index(time.size()), "rows of positions", double(q.rows()), "one per stamp");
    require(q.cols() >= 1 && q.cols() <= 64, "joints", double(q.cols()), "1 to 64");
    require(knot >= 0.01 && knot <= 1, "distance of knots", knot, "0.01 to 1 s");
    for (std::size_t k = 0; k < time.size(); ++k) {
      require(std::isfinite(time[k]) && (k == 0 || time[k] > time[k - 1]), "stamp of a joint position",
              time[k], "finite, later than the one before");
      require(q.row(Eigen::Index(k)).allFinite(), "joint position that is not finite, number", double(k),
              "none");
      if (k > 0 && time[k] - time[k - 1] > 2 * knot) gaps_.push_back({time[k - 1], time[k]});
    }
    start_ = time.front(), end_ = time.back();
    require(end_ - start_ <= 86400, "length of a recording", end_ - start_, "<= 86400 s");
    fit(recording);
  }

  [[nodiscard]] int joints() const noexcept { return int(coefficients_.cols()); }
  /// Begin of the time in which accelerations are known [s]: three knots after the first stamp.
  [[nodiscard]] double start() const noexcept { return start_ + 3 * knot_; }
  /// End of the time in which accelerations are known [s]: three knots before the last stamp.
  [[nodiscard]] double end() const noexcept { return end_ - 3 * knot_; }
  /// The position of the joints at the first stamp; velocities and accelerations are not known there.
  [[nodiscard]] Eigen::VectorXd first() const { return at(start_).q; }
  [[nodiscard]] const std::vector<Gap>& gaps() const noexcept { return gaps_; }
  /// Whether a gap lies between two times.
  [[nodiscard]] bool gap_within(double from, double to) const noexcept {
    return std::any_of(gaps_.begin(), gaps_.end(), [&](const Gap& g) { return g.from < to && g.to > from; });
  }
  /// Standard deviation of each joint's positions from the spline [rad].
  [[nodiscard]] const Eigen::VectorXd& noise() const noexcept { return noise_; }

  /// Positions, velocities and accelerations at `t` [s], which is limited to the recording.
  void at(double t, JointPoint& p) const {
    const auto [first, u] = place(t);
    const detail::fit::QuinticBasis b(u);
    const auto c = coefficients_.middleRows<6>(first);
    using Row = Eigen::Map<const Eigen::Matrix<double, 1, 6>>;
    p.q.noalias() = (Row(b.value) * c).transpose();
    p.dq.noalias() = (Row(b.slope) * c).transpose() / knot_;
    p.ddq.noalias() = (Row(b.bend) * c).transpose() / (knot_ * knot_);
  }
  [[nodiscard]] JointPoint at(double t) const {
    JointPoint p;
    at(t, p);
    return p;
  }

 private:
  struct Place {
    Eigen::Index first;
    double u;
  };
  [[nodiscard]] Place place(double t) const noexcept {
    const double x = std::clamp(t == t ? t : start_, start_, end_);
    const double s = (x - start_) / knot_;
    const double k = std::min(std::floor(s), double(intervals_ - 1));
    return {Eigen::Index(k), s - k};
  }
  void fit(const JointRecording& recording) {
    intervals_ = std::max<Eigen::Index>(1, Eigen::Index(std::ceil((end_ - start_) / knot_)));
    const Eigen::Index n = intervals_ + 5;
    Eigen::MatrixXd band = Eigen::MatrixXd::Zero(6, n);
    coefficients_ = Eigen::MatrixXd::Zero(n, recording.q.cols());
    for (std::size_t k = 0; k < recording.time.size(); ++k) {
      const auto [first, u] = place(recording.time[k]);
      const detail::fit::QuinticBasis b(u);
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j <= i; ++j) band(i - j, first + i) += b.value[i] * b.value[j];
        coefficients_.row(first + i) += b.value[i] * recording.q.row(Eigen::Index(k));
      }
    }
    // Third differences decide where measurements do not.
    const double weight = 1e-6 * band.row(0).mean();
    static constexpr double d[4] = {-1, 3, -3, 1};
    for (Eigen::Index k = 0; k + 3 < n; ++k)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j <= i; ++j) band(i - j, k + i) += weight * d[i] * d[j];
    detail::fit::solve_banded(band, coefficients_);
    noise_ = Eigen::VectorXd::Zero(recording.q.cols());
    JointPoint p;
    for (std::size_t k = 0; k < recording.time.size(); ++k) {
      at(recording.time[k], p);
      noise_ += (recording.q.row(Eigen::Index(k)).transpose() - p.q).cwiseAbs2();
    }
    const double free = std::max(1.0, double(recording.time.size()) - double(n));
    noise_ = (noise_ / free).cwiseSqrt();
  }

  double knot_, start_ = 0, end_ = 0;
  Eigen::Index intervals_ = 1;
  Eigen::MatrixXd coefficients_;
  Eigen::VectorXd noise_;
  std::vector<Gap> gaps_;
};

SKINCTL_END_NAMESPACE
