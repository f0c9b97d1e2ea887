// SPDX-License-Identifier: BSD-3-Clause
// The velocity of a point from its measured positions, with stated noise and lag.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/core/triple.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Position and velocity of a point by an alpha-beta filter with fading memory of time constant `T_v`:
///
///     q = exp(-dt / T_v),  alpha = 1 - q^2,  beta = (1 - q)^2
///     p <- p + v dt,  r = measured - p,  p <- p + alpha r,  v <- v + beta r / dt
///
/// Both poles are at q, so nothing overshoots, and the lag of the velocity is `2 T_v` at any rate, jitter
/// included: the gains follow from the time that passed.
template <Real T = double>
class SpeedEstimate {
 public:
  struct Settings {
    Nanoseconds time_constant = 20ms;  ///< T_v, time constant of the fading memory
    /// Longest gap between samples; after a longer one the velocity begins anew at 0.
    Nanoseconds max_gap = 200ms;
  };
  /// Trivially copyable; `Memory{}` has seen no sample.
  struct Memory {
    Nanoseconds time{};
    Xyz<T> p{T(0), T(0), T(0)};  ///< filtered position [m]
    Xyz<T> v{T(0), T(0), T(0)};  ///< velocity [m/s]
    bool started = false;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit SpeedEstimate(const Settings& s = {})
      : s_(s), per_(T(1) / seconds<T>(s.time_constant)) {
    require(s.time_constant >= 1us && s.time_constant <= 10s, "SpeedEstimate: time constant",
            milliseconds(s.time_constant), "1e-3 to 1e4 ms");
    require(s.max_gap >= s.time_constant && s.max_gap <= 100s, "SpeedEstimate: max_gap",
            milliseconds(s.max_gap), ">= time constant, <= 1e5 ms");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes a position [m] and its stamp. One that is not finite (`sample_not_finite`) or not later than the
  /// last one (`time_backwards`; the same stamp: nothing is wrong) is ignored.
  Status step(Memory& m, Nanoseconds time, const Xyz<T>& measured) const noexcept {
    const T square = dot(measured, measured);
    if (!(square - square == T(0))) return Reason::sample_not_finite;
    if (m.started && time <= m.time) return time == m.time ? Status{} : Status(Reason::time_backwards);
    if (!m.started || time - m.time > s_.max_gap) {
      m = {time, measured, {T(0), T(0), T(0)}, true};
      return {};
    }
    const T dt = seconds<T>(time - m.time);
    using std::expm1;
    const T gone = -expm1(-dt * per_);  // 1 - q
    const Xyz<T> ahead = m.p + dt * m.v, r = measured - ahead;
    m.p = ahead + T(gone * (T(2) - gone)) * r;
    m.v = m.v + T(gone * gone / dt) * r;
    m.time = time;
    return {};
  }

  /// Deviation of the velocity along each axis [m/s] for independent errors of the positions of deviation
  /// `sigma` [m], one every `dt`: `sigma/dt sqrt(2 beta^2 / (alpha (4 - 2 alpha - beta)))`. Infinite for `dt
  /// <= 0`.
  [[nodiscard]] T noise(const T& sigma, Nanoseconds dt) const noexcept {
    if (!(dt > 0ns)) return std::numeric_limits<T>::infinity();
    using std::expm1;
    using std::sqrt;
    const T h = seconds<T>(dt), gone = -expm1(-h * per_), alpha = gone * (T(2) - gone), beta = gone * gone;
    return sigma / h * beta * sqrt(T(2) / (alpha * (T(4) - T(2) * alpha - beta)));
  }
  /// Delay of the estimated velocity behind a slow motion: 2 T_v.
  [[nodiscard]] Nanoseconds lag() const noexcept { return 2 * s_.time_constant; }

 private:
  Settings s_;
  T per_;  ///< 1 / T_v [1/s]
};

SKINCTL_END_NAMESPACE
