// SPDX-License-Identifier: BSD-3-Clause
// Joint velocities for devices that report positions only, with stated lag and noise.
#pragma once

#include <array>
#include <cmath>
#include <complex>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The velocity of `N` joints from their last `K` stamped positions: the slope, at the newest one, of the
/// polynomial of degree `Degree` that fits them best (least squares). Irregular stamps are exact.
///
/// | degree | exact for             | lag of a slow motion | deviation of the velocity for one of positions   |
/// |--------|-----------------------|----------------------|--------------------------------------------------|
/// | 1      | constant velocity     | (K - 1)/2 periods    | about sqrt(12 / K^3) / period                    |
/// | 2      | constant acceleration | 0                    | about sqrt(192 / K^3) / period, and it overshoots |
///
/// `lag()`, `noise()` and `response(frequency)` state the exact figures for samples that come every period; a
/// lost sample lengthens the window by one period. Positions pass as they are.
///
/// For a law by torque the lag is a delay: it belongs into the description's `delay`.
///
/// The Allegro hand (333 Hz, steps of 0.089 mrad): K = 5, degree 1 lags by 6 ms and has 2.7 mrad/s of noise;
/// the difference of two positions 1.5 ms and 12 mrad/s.
template <std::size_t N, std::size_t K = 5, std::size_t Degree = 1, Real T = double>
class VelocityEstimator {
  static_assert(Degree == 1 || Degree == 2, "a line (1) or a parabola (2)");
  static_assert(K > Degree && K <= 64, "more samples than the degree, at most 64");

 public:
  static constexpr std::size_t joints = N;
  static constexpr std::size_t window = K;
  using scalar = T;
  struct Settings {
    Nanoseconds period = 3ms;  ///< planned time between two samples
    /// Longest gap between samples; after a longer one the velocity begins anew at 0.
    Nanoseconds max_gap = 50ms;
    T step = T(0);  ///< step of the encoders [rad], for `noise`; 0: none
  };
  struct Memory {
    std::size_t count = 0;  ///< samples in the window
    std::size_t next = 0;   ///< index of the next sample
    std::array<Nanoseconds, K> stamp{};
    std::array<JointPosition<N, T>, K> q{};
    State<N, T> state{};  ///< newest state
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      return a.count == b.count && a.next == b.next && a.stamp == b.stamp && a.q == b.q &&
             a.state.time == b.state.time && a.state.q == b.state.q && a.state.dq == b.state.dq;
    }
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit VelocityEstimator(const Settings& settings = {}) : s_(settings) {
    require(s_.period > 0ns && s_.period <= 1s, "VelocityEstimator: period", milliseconds(s_.period),
            "> 0 ms, <= 1 s");
    require(s_.max_gap >= s_.period && s_.max_gap <= 10s, "VelocityEstimator: max_gap",
            milliseconds(s_.max_gap), ">= period, <= 10 s [ms]");
    require(s_.step >= T(0) && s_.step <= T(1), "VelocityEstimator: step", double(s_.step), "0 to 1 rad");
    for (std::size_t i = 0; i < K; ++i)
      planned_[i] = -seconds<T>(s_.period) * static_cast<T>(static_cast<int>(i));
    slopes(planned_, K, weights_);
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes a position and its stamp; the newest state is in the memory, with a velocity of 0 until a second
  /// sample has come.
  ///
  /// - A position that is not finite or absurd: `state_not_finite`, nothing changes.
  /// - A stamp before the last one: `time_backwards`, nothing changes; one that goes back by more than
  ///   `max_gap` is a clock that was set back, and the window begins anew.
  /// - The same stamp again: a repeated message, nothing changes and nothing is wrong.
  /// - Samples closer than a quarter of a period together leave the velocity as it is until the window is
  ///   longer than that.
  Status observe(Memory& memory, const JointPosition<N, T>& q, Nanoseconds stamp) const noexcept {
    if (!detail::within(q, T(detail::plausible)) || !detail::is_plausible(stamp))
      return Reason::state_not_finite;
    if (memory.count > 0) {
      const Nanoseconds since = stamp - memory.state.time;
      if (since == 0ns) return {};
      if (since < 0ns && since >= -s_.max_gap) return Reason::time_backwards;
      if (since < 0ns || since > s_.max_gap) memory = Memory{};
    }
    memory.stamp[memory.next] = stamp;
    memory.q[memory.next] = q;
    memory.next = memory.next + 1 == K ? 0 : memory.next + 1;
    memory.count = memory.count < K ? memory.count + 1 : K;
    memory.state.time = stamp;
    memory.state.q = q;

    // From the newest to the oldest.
    T time[K], weight[K];
    std::size_t place[K];
    for (std::size_t i = 0; i < memory.count; ++i) {
      place[i] = (memory.next + K - 1 - i) % K;
      time[i] = -seconds<T>(stamp - memory.stamp[place[i]]);
    }
    if (!(-time[memory.count - 1] >= T(0.25) * seconds<T>(s_.period))) return {};
    slopes(time, memory.count, weight);
    JointVelocity<N, T> dq;
    for (std::size_t i = 1; i < memory.count; ++i)  // the weights add up to 0
      for (std::size_t j = 0; j < N; ++j) dq[j] = dq[j] + weight[i] * (memory.q[place[i]][j] - q[j]);
    memory.state.dq = dq;
    return {};
  }

  /// Delay of the velocity of a slow motion, for samples on time.
  [[nodiscard]] Nanoseconds lag() const noexcept {
    return Degree == 1 ? s_.period * static_cast<std::int64_t>(K - 1) / 2 : 0ns;
  }
  /// Standard deviation of the velocity from encoder steps, `step / sqrt(12)` in each position [rad/s].
  /// (Positions within a step are taken as evenly distributed and independent; a slow joint repeats its
  /// readings, and its error is bounded by `worst_noise`.)
  [[nodiscard]] T noise() const noexcept {
    using std::sqrt;
    return s_.step * gain_of_noise() * T(1 / sqrt(12.0));
  }
  /// Upper bound of the velocity's error from encoder steps [rad/s].
  [[nodiscard]] T worst_noise() const noexcept {
    T sum(0);
    for (const T& w : weights_) sum = sum + (w < T(0) ? T(-w) : w);
    return T(0.5) * s_.step * sum;
  }
  /// Standard deviation of the velocity per standard deviation of independent positions [1/s].
  [[nodiscard]] T gain_of_noise() const noexcept {
    using std::sqrt;
    T sum(0);
    for (const T& w : weights_) sum = sum + w * w;
    return sqrt(sum);
  }
  /// Estimated over true velocity of a sinusoid of this frequency [Hz] > 0: amplitude and phase.
  [[nodiscard]] SKINCTL_COLD std::complex<double> response(double frequency) const {
    const double w = 2 * 3.14159265358979323846 * frequency;
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < K; ++i)
      sum += double(weights_[i]) * std::exp(std::complex<double>(0, w * double(planned_[i])));
    return sum / std::complex<double>(0, w);
  }

 private:
  /// Writes the weights of `n` positions in the slope at time 0 [1/s]; `time` [s] falls from 0. By
  /// polynomials that are orthogonal on these times.
  static SKINCTL_INLINE void slopes(const T* time, std::size_t n, T* weight) noexcept {
    if (n < 2) {
      weight[0] = T(0);
      return;
    }
    const T span = -time[n - 1], per = T(1) / span, share = T(1) / static_cast<T>(static_cast<int>(n));
    T mean(0), square(0), cube(0);
    for (std::size_t i = 0; i < n; ++i) mean = mean + share * (time[i] * per);
    for (std::size_t i = 0; i < n; ++i) {
      const T u = time[i] * per - mean;
      square = square + u * u;
      cube = cube + u * u * u;
    }
    for (std::size_t i = 0; i < n; ++i) weight[i] = per * (time[i] * per - mean) / square;
    if constexpr (Degree == 2) {
      const T a = cube / square, b = share * square;
      T size(0);
      const auto parabola = [&](const T& t) SKINCTL_INLINE_LAMBDA {
        const T u = t * per - mean;
        return T(u * u - a * u - b);
      };
      for (std::size_t i = 0; i < n; ++i) size = size + parabola(time[i]) * parabola(time[i]);
      if (!(n > 2 && size > T(1e-6))) return;  // as good as two times only: a line
      const T slope = (T(-2) * mean - a) / size;
      for (std::size_t i = 0; i < n; ++i) weight[i] = weight[i] + per * slope * parabola(time[i]);
    }
  }

  static_assert(std::is_trivially_copyable_v<Memory>);
  Settings s_;
  T planned_[K], weights_[K];
};

SKINCTL_END_NAMESPACE
