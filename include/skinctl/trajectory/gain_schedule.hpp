// SPDX-License-Identifier: BSD-3-Clause
// The proportional gain over time: the time base up to its peak, held there, then a constant.
#pragma once

#include "skinctl/trajectory/time_base.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `K_p(t)`: `K_tbg` until its peak at `t_p`, constant at that peak until `tb`, then by a quintic to the
/// constant `K_c`, where it stays. The time base alone returns to zero at tb and would stop controlling.
/// Continuous with its derivative.
///
/// An error with `dx = -K_p x` has
///
///     x(tb) = x0 ((1 - xi(t_p) + delta) / (1 + delta))^(1 + eps) exp(-K_peak (tb - t_p)).
template <Real T = double>
class GainSchedule {
 public:
  /// @param K_c     gain that holds the target [1/s], > 0.
  /// @param settle  duration of the change from the peak to K_c, as a multiple of tb, > 0.
  /// Throws `ConfigurationError` for others.
  explicit GainSchedule(const T& K_c = T(10), const TimeBase<T>& base = TimeBase<T>(),
                        const T& settle = T(0.5))
      : base_(base), K_c_(K_c), settle_(settle) {
    require(K_c > T(0) && K_c <= T(1e6), "K_c", static_cast<double>(K_c), "> 0 1/s");
    require(settle > T(0) && settle <= T(1e3), "settle of the gain schedule", static_cast<double>(settle),
            "> 0, in multiples of tb");
  }

  /// The gain `t` seconds after the start, for the convergence time `tb` [s]; `K_c` at all times if `tb` is
  /// not positive. Zero before the start.
  [[nodiscard]] SKINCTL_INLINE constexpr Gain<T> at(const T& t, const T& tb) const noexcept {
    if (!(tb > T(0))) return {K_c_, T(0)};
    const T rate = T(1) / tb;
    const T r = t / tb;
    if (r < base_.peak_time()) {
      const auto unit = base_.gain(r);
      return {rate * unit.K, rate * rate * unit.dK};
    }
    const T K_peak = rate * base_.peak_gain();
    if (r < T(1)) return {K_peak, T(0)};
    const auto way = quintic(T((r - T(1)) / settle_), T(rate / settle_));
    return {way.rest * K_peak + way.a1 * K_c_, way.a2 * (K_c_ - K_peak)};
  }
  /// A gain that starts at `K_from` [1/s], small enough for a large error, and goes to `K_c` by a quintic
  /// over `8 / K_from`; by then nearly all of the error is gone. `K_c` at all times if it is not larger than
  /// `K_from`.
  [[nodiscard]] SKINCTL_INLINE constexpr Gain<T> rising(const T& t, const T& K_from) const noexcept {
    if (!(K_from < K_c_)) return {K_c_, T(0)};
    const T rate = T(0.125) * K_from;
    const auto way = quintic(T(t * rate), rate);
    return {way.rest * K_from + way.a1 * K_c_, way.a2 * (K_c_ - K_from)};
  }
  /// The largest gain that occurs for the convergence time `tb` [s], in [1/s].
  [[nodiscard]] constexpr T largest(const T& tb) const noexcept {
    if (!(tb > T(0))) return K_c_;
    const T K_peak = base_.peak_gain() / tb;
    return K_peak > K_c_ ? K_peak : K_c_;
  }
  [[nodiscard]] constexpr const TimeBase<T>& base() const noexcept { return base_; }
  [[nodiscard]] constexpr const T& K_c() const noexcept { return K_c_; }

  /// The shortest convergence time [s] for which an error that starts at `x0` keeps its speed below `dx_max`:
  /// `1.886 |x0| / dx_max` for the default time base.
  [[nodiscard]] constexpr T shortest_time(const T& x0, const T& dx_max) const noexcept {
    const T size = x0 < T(0) ? T(-x0) : x0;
    return base_.peak_speed() * size / dx_max;
  }

 private:
  TimeBase<T> base_;
  T K_c_, settle_;
};

SKINCTL_END_NAMESPACE
