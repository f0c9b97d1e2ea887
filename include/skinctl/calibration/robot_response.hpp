// How a robot answers position commands: delay, lag, stiffness, gap, resolution, jitter, from a log of a gentle motion.
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

/// The position of a robot with `delay` and `lag` at the times of `measured`, and the sign of its motion.
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

/// The smallest step of which all changes are multiples, to 5 %; 0 if there is none.
inline double step_of(std::vector<double> changes) {
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

}  // namespace detail

/// Identifies a robot by position from a log, by least squares: a grid of delay and lag, then Gauss-Newton on these
/// two and the three numbers of each joint together. The first half second is left out: a servo that takes its load
/// over settles then. Deviations come from the residuals, which are taken for
/// correlated as they are.
///
/// Throws `ConfigurationError` for a log that is too short (200 measurements), not in order, or not finite.
///
/// @param model  for G(q), which shows a servo's stiffness.
template <RobotModel M>
[[nodiscard]] RobotResponse<M::joints> identify_response(const M& model, const ResponseLog<M::joints>& log) {
  constexpr std::size_t N = M::joints;
  const std::size_t count = log.measured.size();
  require(count >= 200, "measurements", double(count), ">= 200");
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

  RobotResponse<N> out;
  // Intervals.
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

  // What does not depend on delay and lag: gravity, the direction of motion.
  std::vector<std::array<double, N>> gravity(count), side(count);
  std::array<double, N> last = log.measured.front().q, direction{};
  std::array<bool, N> reverses{};
  for (std::size_t k = 0; k < count; ++k) {
    const auto& q = log.measured[k].q;
    for (std::size_t i = 0; i < N; ++i) {
      // A direction counts after 2 mrad, beyond noise.
      if (std::abs(q[i] - last[i]) > 2e-3) {
        const double now = q[i] > last[i] ? 1 : -1;
        reverses[i] = reverses[i] || now * direction[i] < 0;
        direction[i] = now;
        last[i] = q[i];
      } else if ((q[i] - last[i]) * direction[i] > 0) {
        last[i] = q[i];
      }
      side[k][i] = direction[i];
    }
  }
  out.skipped = lost / (double(count) + lost);

  std::array<bool, N> bends{};
  const auto& plays = reverses;
  // The encoders are off by the gap, the arm is not.
  const auto weigh = [&](const std::array<double, N>& gap) {
    std::array<double, N> least, most;
    least.fill(1e300), most.fill(-1e300);
    for (std::size_t k = 0; k < count; ++k) {
      JointPosition<N> q(log.measured[k].q);
      for (std::size_t i = 0; i < N; ++i) q[i] -= gap[i];
      const auto G = gravity_torque(model, q);
      for (std::size_t i = 0; i < N; ++i) {
        gravity[k][i] = G[i];
        least[i] = std::min(least[i], G[i]), most[i] = std::max(most[i], G[i]);
      }
    }
    for (std::size_t i = 0; i < N; ++i) bends[i] = most[i] - least[i] > 0.05;
  };
  weigh({});
  constexpr int per = 3;
  constexpr int unknown = 2 + per * int(N);
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;
  std::array<double, N> weight;
  weight.fill(1);
  std::vector<double> base, by_delay, by_lag;
  const double h = 1e-4;

  std::size_t settled = 0;
  while (settled + 100 < count && log.measured[settled].time < log.measured.front().time + 0.5) ++settled;
  const double used = double(count - settled);

  // The linear numbers of one joint for a delay and a lag, and the squares that remain.
  const auto fit_joint = [&](std::size_t i, double delay, double lag, Eigen::Vector3d& x) {
    detail::respond(log, i, delay, lag, base);
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    double squares = 0;
    for (std::size_t k = settled; k < count; ++k) {
      const Eigen::Vector3d row(1, bends[i] ? -gravity[k][i] : 0, plays[i] ? -side[k][i] : 0);
      const double y = log.measured[k].q[i] - base[k];
      A += row * row.transpose(), b += row * y, squares += y * y;
    }
    for (int r = 0; r < 3; ++r)
      if (A(r, r) == 0) A(r, r) = 1;
    x = detail::solve_symmetric(A, b);
    return std::max(0.0, squares - x.dot(b));
  };
  double delay = 0, lag = 0;
  {
    double best = 1e300;
    for (double d = 0; d <= 0.1001; d += 0.005)
      for (double l = 0; l <= 0.1001; l += 0.005) {
        double cost = 0;
        Eigen::Vector3d x;
        for (std::size_t i = 0; i < N; ++i) cost += fit_joint(i, d, l, x);
        if (cost < best) best = cost, delay = d, lag = l;
      }
  }

  Matrix normal(unknown, unknown);
  Vector right(unknown), solution = Vector::Zero(unknown);
  std::array<double, N> variance{}, correlation{};
  for (int round = 0; round < 12; ++round) {
    if (round > 0 && round < 6) {
      std::array<double, N> gap;
      for (std::size_t i = 0; i < N; ++i) gap[i] = solution(2 + per * int(i));
      weigh(gap);
    }
    normal.setZero();
    right.setZero();
    for (std::size_t i = 0; i < N; ++i) {
      Eigen::Vector3d x;
      fit_joint(i, delay, lag, x);
      detail::respond(log, i, delay, lag, base);
      detail::respond(log, i, delay + h, lag, by_delay);
      detail::respond(log, i, delay, lag + h, by_lag);
      double squares = 0, neighbours = 0, before = 0;
      Vector row = Vector::Zero(unknown);
      const int at = 2 + per * int(i);
      for (std::size_t k = settled; k < count; ++k) {
        row(0) = (by_delay[k] - base[k]) / h;
        row(1) = (by_lag[k] - base[k]) / h;
        row(at) = 1;
        row(at + 1) = bends[i] ? -gravity[k][i] : 0;
        row(at + 2) = plays[i] ? -side[k][i] : 0;
        const double rest = log.measured[k].q[i] - base[k] - x(0) - row(at + 1) * x(1) - row(at + 2) * x(2);
        squares += rest * rest;
        neighbours += rest * before;
        before = rest;
        for (const int a : {0, 1, at, at + 1, at + 2}) {
          right(a) += weight[i] * row(a) * rest;
          for (const int b : {0, 1, at, at + 1, at + 2}) normal(a, b) += weight[i] * row(a) * row(b);
        }
      }
      for (int r = 0; r < per; ++r) solution(at + r) = x(r);
      variance[i] = std::max(squares / used, 1e-18);
      correlation[i] = squares > 0 ? std::clamp(neighbours / squares, 0.0, 0.999) : 0;
    }
    for (int r = 0; r < unknown; ++r)
      if (normal(r, r) == 0) normal(r, r) = 1;
    const Vector step = detail::solve_symmetric(normal, right);
    // Correlated residuals tell less: (1 + c)/(1 - c) of them are worth one.
    for (std::size_t i = 0; i < N; ++i) weight[i] = (1 - correlation[i]) / (1 + correlation[i]) / variance[i];
    delay = std::clamp(delay + std::clamp(step(0), -5e-3, 5e-3), 0.0, 0.5);
    lag = std::clamp(lag + std::clamp(step(1), -5e-3, 5e-3), 0.0, 0.5);
  }
  const Matrix covariance = detail::solve_symmetric(normal, Matrix::Identity(unknown, unknown));
  const auto deviation = [&](int k) { return std::sqrt(std::max(0.0, covariance(k, k))); };
  double moved = 0;
  for (std::size_t i = 0; i < N; ++i) {
    double low = 1e300, high = -1e300;
    for (const auto& s : log.sent) low = std::min(low, s.q[i]), high = std::max(high, s.q[i]);
    moved = std::max(moved, high - low);
  }
  if (moved > 1e-3) {
    out.delay = {delay, deviation(0)};
    out.lag = {lag, deviation(1)};
    out.both = {delay + lag,
                std::sqrt(std::max(0.0, covariance(0, 0) + 2 * covariance(0, 1) + covariance(1, 1)))};
  }
  for (std::size_t i = 0; i < N; ++i) {
    auto& j = out.joint[i];
    const int at = 2 + per * int(i);
    j.gap = {solution(at), deviation(at)};
    if (bends[i]) j.compliance = {solution(at + 1), deviation(at + 1)};
    if (plays[i]) j.hysteresis = {solution(at + 2), deviation(at + 2)};
    j.noise = std::sqrt(variance[i]);
    std::vector<double> changes;
    for (std::size_t k = 1; k < count; ++k) {
      const double dt = log.measured[k].time - log.measured[k - 1].time;
      const double dq = std::abs(log.measured[k].q[i] - log.measured[k - 1].q[i]);
      changes.push_back(dq);
      if (k >= 4 && dt > 0) {  // over four intervals, so that noise counts less
        const double span = log.measured[k].time - log.measured[k - 4].time;
        j.speed = std::max(j.speed, std::abs(log.measured[k].q[i] - log.measured[k - 4].q[i]) / span);
      }
    }
    j.resolution = detail::step_of(std::move(changes));
  }
  return out;
}

SKINCTL_END_NAMESPACE
