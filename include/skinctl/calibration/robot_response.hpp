// SPDX-License-Identifier: BSD-3-Clause
// How a robot answers position commands: delay, lag, stiffness, gap, resolution, jitter, from a log of a
// gentle motion.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "skinctl/calibration/detail/symmetric.hpp"
#include "skinctl/calibration/robot_response_types.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/dynamics/gravity.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {

/// Sets `position` to the positions [rad] of a joint with `delay` and `lag` [s], at the times of `measured`.
template <std::size_t N>
void respond(const ResponseLog<N>& log, std::size_t joint, double delay, double lag,
             std::vector<double>& position) {
  position.clear();
  std::size_t next = 0;
  double now = log.sent.front().time, target = log.sent.front().q[joint], at = target;
  const auto run = [&](double to) {
    if (to <= now) return;
    at = lag > 1e-9 ? target + (at - target) * std::exp((now - to) / lag) : target;
    now = to;
  };
  for (const auto& m : log.measured) {
    while (next < log.sent.size() && log.sent[next].time + delay <= m.time) {
      run(log.sent[next].time + delay);
      target = log.sent[next++].q[joint];
    }
    run(m.time);
    position.push_back(lag > 1e-9 ? at : target);
  }
}

/// The smallest step [rad] of which all `changes` [rad] are multiples, to 5 %; 0 if there is none.
inline double encoder_step(std::vector<double> changes) {
  std::erase_if(changes, [](double x) { return !(x > 1e-9); });
  if (changes.size() < 8) return 0;
  std::sort(changes.begin(), changes.end());
  double step = changes.front(), sum = 0, count = 0;
  for (const double x : changes) {
    const double n = std::round(x / step);
    if (n > 20) break;
    if (std::abs(x - n * step) > 0.05 * step) return 0;
    sum += x, count += n;
    step = sum / count;
  }
  return step;
}

/// Throws `ConfigurationError` for a log that is too short, not in order, or not finite.
template <std::size_t N>
void check_log(const ResponseLog<N>& log) {
  require(log.measured.size() >= 200, "measurements", double(log.measured.size()), ">= 200");
  require(log.sent.size() >= 2, "commands", double(log.sent.size()), ">= 2");
  const auto check = [](const auto& entries, const char* what) {
    for (std::size_t k = 0; k < entries.size(); ++k) {
      bool fine = std::isfinite(entries[k].time) && (k == 0 || entries[k].time >= entries[k - 1].time);
      for (const double x : entries[k].q) fine = fine && std::isfinite(x);
      require(fine, what, double(k), "finite, and not before the entry in front of it");
    }
  };
  check(log.sent, "command");
  check(log.measured, "measurement");
}

/// Sets the period, the jitter and the share of lost measurements.
template <std::size_t N>
void find_intervals(const ResponseLog<N>& log, RobotResponse<N>& out) {
  const std::size_t count = log.measured.size();
  std::vector<double> gaps;
  for (std::size_t k = 1; k < count; ++k) gaps.push_back(log.measured[k].time - log.measured[k - 1].time);
  auto sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  out.period = sorted[sorted.size() / 2];
  double lost = 0, square = 0, regular = 0;
  for (const double g : gaps) {
    const double n = out.period > 0 ? std::max(1.0, std::round(g / out.period)) : 1;
    lost += n - 1;
    if (n < 1.5) square += (g - out.period) * (g - out.period), regular += 1;
  }
  out.jitter = regular > 0 ? std::sqrt(square / regular) : 0;
  out.skipped = lost / (double(count) + lost);
}

/// Sets the largest speed and the resolution of joint `i`.
template <std::size_t N>
void find_changes(const ResponseLog<N>& log, std::size_t i, typename RobotResponse<N>::Joint& joint) {
  std::vector<double> changes;
  for (std::size_t k = 1; k < log.measured.size(); ++k) {
    const double dt = log.measured[k].time - log.measured[k - 1].time;
    changes.push_back(std::abs(log.measured[k].q[i] - log.measured[k - 1].q[i]));
    if (k >= 4 && dt > 0) {  // over four intervals, so that noise counts less
      const double span = log.measured[k].time - log.measured[k - 4].time;
      joint.speed = std::max(joint.speed, std::abs(log.measured[k].q[i] - log.measured[k - 4].q[i]) / span);
    }
  }
  joint.resolution = encoder_step(std::move(changes));
}

/// The least squares of `identify_response`.
template <RobotModel M>
class ResponseFit {
 public:
  static constexpr std::size_t N = M::joints;
  static constexpr int per = 3, unknown = 2 + per * int(N);  ///< number of unknowns of a joint, and of all
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  ResponseFit(const M& model, const ResponseLog<N>& log)
      : model_(model), log_(log), gravity_(log.measured.size()), side_(log.measured.size()) {
    find_sides();
    weigh({});
    weight_.fill(1);
    const auto& m = log.measured;
    while (settled_ + 100 < m.size() && m[settled_].time < m.front().time + 0.5) ++settled_;
    search();
    for (int round = 0; round < 12; ++round) {
      if (round > 0 && round < 6) {
        std::array<double, N> gap;
        for (std::size_t i = 0; i < N; ++i) gap[i] = solution_(2 + per * int(i));
        weigh(gap);
      }
      step();
    }
  }
  void tell(RobotResponse<N>& out) const {
    const Matrix covariance = solve_symmetric(normal_, Matrix::Identity(unknown, unknown));
    const auto deviation = [&](int k) { return std::sqrt(std::max(0.0, covariance(k, k))); };
    double moved = 0;
    for (std::size_t i = 0; i < N; ++i) {
      double low = 1e300, high = -1e300;
      for (const auto& s : log_.sent) low = std::min(low, s.q[i]), high = std::max(high, s.q[i]);
      moved = std::max(moved, high - low);
    }
    if (moved > 1e-3) {
      out.delay = {delay_, deviation(0)};
      out.lag = {lag_, deviation(1)};
      out.total_delay = {delay_ + lag_, std::sqrt(std::max(0.0, covariance(0, 0) + 2 * covariance(0, 1) +
                                                                    covariance(1, 1)))};
    }
    for (std::size_t i = 0; i < N; ++i) {
      auto& j = out.joint[i];
      const int at = 2 + per * int(i);
      j.gap = {solution_(at), deviation(at)};
      if (bends_[i]) j.compliance = {solution_(at + 1), deviation(at + 1)};
      if (plays_[i]) j.hysteresis = {solution_(at + 2), deviation(at + 2)};
      j.noise = std::sqrt(variance_[i]);
      find_changes(log_, i, j);
    }
  }

 private:
  /// Finds the direction in which each joint moved last.
  void find_sides() {
    std::array<double, N> last = log_.measured.front().q, direction{};
    for (std::size_t k = 0; k < log_.measured.size(); ++k) {
      const auto& q = log_.measured[k].q;
      for (std::size_t i = 0; i < N; ++i) {
        if (std::abs(q[i] - last[i]) > 2e-3) {  // a direction counts after 2 mrad, beyond noise
          const double now = q[i] > last[i] ? 1 : -1;
          plays_[i] = plays_[i] || now * direction[i] < 0;
          direction[i] = now;
          last[i] = q[i];
        } else if ((q[i] - last[i]) * direction[i] > 0) {
          last[i] = q[i];
        }
        side_[k][i] = direction[i];
      }
    }
  }
  /// Sets gravity's torques, at the measured positions less `gap` [rad]: the encoders are off by it, the arm
  /// is not.
  void weigh(const std::array<double, N>& gap) {
    std::array<double, N> low, high;
    low.fill(1e300), high.fill(-1e300);
    for (std::size_t k = 0; k < log_.measured.size(); ++k) {
      JointPosition<N> q(log_.measured[k].q);
      for (std::size_t i = 0; i < N; ++i) q[i] -= gap[i];
      const auto G = gravity_torque(model_, q);
      for (std::size_t i = 0; i < N; ++i) {
        gravity_[k][i] = G[i];
        low[i] = std::min(low[i], G[i]), high[i] = std::max(high[i], G[i]);
      }
    }
    for (std::size_t i = 0; i < N; ++i) bends_[i] = high[i] - low[i] > 0.05;
  }
  /// The linear unknowns `x` of one joint for a delay and a lag [s]; returns the sum of squared residuals.
  double fit_joint(std::size_t i, double delay, double lag, Eigen::Vector3d& x) {
    respond(log_, i, delay, lag, base_);
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double squares = 0;
    for (std::size_t k = settled_; k < log_.measured.size(); ++k) {
      const Eigen::Vector3d row(1, bends_[i] ? -gravity_[k][i] : 0, plays_[i] ? -side_[k][i] : 0);
      const double y = log_.measured[k].q[i] - base_[k];
      A += row * row.transpose(), b += row * y, squares += y * y;
    }
    for (int r = 0; r < 3; ++r)
      if (A(r, r) == 0) A(r, r) = 1;
    x = solve_symmetric(A, b);
    return std::max(0.0, squares - x.dot(b));
  }
  /// Finds delay and lag on a grid.
  void search() {
    double best = 1e300;
    for (double d = 0; d <= 0.1001; d += 0.005)
      for (double l = 0; l <= 0.1001; l += 0.005) {
        double cost = 0;
        Eigen::Vector3d x;
        for (std::size_t i = 0; i < N; ++i) cost += fit_joint(i, d, l, x);
        if (cost < best) best = cost, delay_ = d, lag_ = l;
      }
  }
  /// One step of Gauss-Newton on all unknowns together.
  void step() {
    normal_.setZero();
    right_.setZero();
    for (std::size_t i = 0; i < N; ++i) add_joint(i);
    for (int r = 0; r < unknown; ++r)
      if (normal_(r, r) == 0) normal_(r, r) = 1;
    const Vector change = solve_symmetric(normal_, right_);
    // Correlated residuals tell less: (1 + c)/(1 - c) of them are worth one.
    for (std::size_t i = 0; i < N; ++i)
      weight_[i] = (1 - correlation_[i]) / (1 + correlation_[i]) / variance_[i];
    delay_ = std::clamp(delay_ + std::clamp(change(0), -5e-3, 5e-3), 0.0, 0.5);
    lag_ = std::clamp(lag_ + std::clamp(change(1), -5e-3, 5e-3), 0.0, 0.5);
  }
  void add_joint(std::size_t i) {
    constexpr double h = 1e-4;
    Eigen::Vector3d x;
    fit_joint(i, delay_, lag_, x);
    respond(log_, i, delay_, lag_, base_);
    respond(log_, i, delay_ + h, lag_, by_delay_);
    respond(log_, i, delay_, lag_ + h, by_lag_);
    double squares = 0, neighbours = 0, before = 0;
    Vector row = Vector::Zero(unknown);
    const int at = 2 + per * int(i);
    for (std::size_t k = settled_; k < log_.measured.size(); ++k) {
      row(0) = (by_delay_[k] - base_[k]) / h;
      row(1) = (by_lag_[k] - base_[k]) / h;
      row(at) = 1;
      row(at + 1) = bends_[i] ? -gravity_[k][i] : 0;
      row(at + 2) = plays_[i] ? -side_[k][i] : 0;
      const double rest = log_.measured[k].q[i] - base_[k] - x(0) - row(at + 1) * x(1) - row(at + 2) * x(2);
      squares += rest * rest;
      neighbours += rest * before;
      before = rest;
      for (const int a : {0, 1, at, at + 1, at + 2}) {
        right_(a) += weight_[i] * row(a) * rest;
        for (const int b : {0, 1, at, at + 1, at + 2}) normal_(a, b) += weight_[i] * row(a) * row(b);
      }
    }
    for (int r = 0; r < per; ++r) solution_(at + r) = x(r);
    variance_[i] = std::max(squares / double(log_.measured.size() - settled_), 1e-18);
    correlation_[i] = squares > 0 ? std::clamp(neighbours / squares, 0.0, 0.999) : 0;
  }

  const M& model_;
  const ResponseLog<N>& log_;
  std::vector<std::array<double, N>> gravity_, side_;  ///< gravity torques, signs of motion
  std::array<bool, N> bends_{}, plays_{};              ///< whether compliance and hysteresis show
  std::array<double, N> weight_, variance_{}, correlation_{};
  std::size_t settled_ = 0;  ///< index of the first measurement that counts
  double delay_ = 0, lag_ = 0;
  Matrix normal_ = Matrix::Zero(unknown, unknown);
  Vector right_ = Vector::Zero(unknown), solution_ = Vector::Zero(unknown);
  std::vector<double> base_, by_delay_, by_lag_;
};

}  // namespace detail

/// Identifies a robot by position from a log, by least squares: a grid of delay and lag, then Gauss-Newton on
/// these two and the three numbers of each joint together. The first half second is left out: a servo that
/// takes its load over settles then. Deviations come from the residuals, which are taken for
/// correlated as they are.
///
/// Throws `ConfigurationError` for a log that is too short (200 measurements), not in order, or not finite.
///
/// @param model  for G(q), which shows a servo's stiffness.
template <RobotModel M>
[[nodiscard]] RobotResponse<M::joints> identify_response(const M& model, const ResponseLog<M::joints>& log) {
  detail::check_log(log);
  RobotResponse<M::joints> out;
  detail::find_intervals(log, out);
  detail::ResponseFit<M>(model, log).tell(out);
  return out;
}

SKINCTL_END_NAMESPACE
