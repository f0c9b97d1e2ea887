// SPDX-License-Identifier: BSD-3-Clause
// The time base: a gain that brings an error nearly to zero at a chosen time, eq. (11).
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/trajectory/quintic.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A gain and its derivative in time.
template <Real T = double>
struct Gain {
  T K;   ///< gain [1/s]
  T dK;  ///< derivative of the gain [1/s^2]
};

namespace detail {
/// The zero of `f`, which is negative at `low` and positive behind it: bisection until no number lies
/// between.
template <Real T, class F>
T sign_change(T low, T high, const F& f) {
  for (int i = 0; i < 4096; ++i) {
    const T middle = low + T(0.5) * (high - low);
    if (!(middle > low && middle < high)) break;
    (f(middle) < T(0) ? low : high) = middle;
  }
  return high;
}
}  // namespace detail

/// The time base of eq. (11) over one unit of time: `xi(r)` is the quintic, `n = (1 - xi) + delta`, and
/// `K_tbg = (1 + eps) dxi / n`. An error with `dx = -K_tbg x` ends at `x0 (delta / (1 + delta))^(1 + eps)`,
/// however long the time is. For a convergence time `tb` the gain is divided by tb and its derivative by
/// tb^2.
///
/// @tparam T  scalar.
template <Real T = double>
class TimeBase {
 public:
  /// @param eps    > 0: the error decays by the power 1 + eps of the time base.
  /// @param delta  >= 1e-12: keeps the gain finite at the end; the remaining error grows with it.
  /// Throws `ConfigurationError` for others.
  SKINCTL_COLD explicit TimeBase(const T& eps = T(0.05), const T& delta = T(0.01))
      : eps_(eps), delta_(delta) {
    require(eps > T(0) && eps <= T(10), "eps of the time base", static_cast<double>(eps), "> 0 and <= 10");
    require(delta >= T(1e-12) && delta <= T(10), "delta of the time base", static_cast<double>(delta),
            "1e-12 to 10");
    // With s = 1 - r: the gain peaks where d/dr (dxi / n) = 0, the speed K x where d/dr (dxi n^eps) = 0.
    const auto peak = [this](const T& weight) {
      return [this, weight](const T& s) -> T {
        const auto q = quintic(s);
        return q.a3 * (q.a1 + delta_) - weight * q.a2 * q.a2;
      };
    };
    const T s_gain = detail::sign_change(T(0), T(0.5), [f = peak(T(1))](const T& s) -> T { return -f(s); });
    const T s_speed =
        detail::sign_change(T(0.5), T(1), [f = peak(T(-eps))](const T& s) -> T { return -f(s); });
    peak_time_ = T(1) - s_gain;
    peak_gain_ = gain(peak_time_).K;
    using std::pow;
    const auto q = quintic(s_speed);
    peak_speed_ = (T(1) + eps) * q.a2 * pow(T(q.a1 + delta), eps) / pow(T(T(1) + delta), T(T(1) + eps));
  }

  /// The gain `K_tbg` and its derivative at the time ratio `r`, for tb = 1; both are zero outside of [0, 1]
  /// and at its ends.
  [[nodiscard]] SKINCTL_INLINE constexpr Gain<T> gain(const T& r) const noexcept {
    const auto xi = quintic(r);
    const T ratio = T(1) / (xi.rest + delta_);
    const T speed = xi.a2 * ratio;
    return {(T(1) + eps_) * speed, (T(1) + eps_) * (xi.a3 * ratio + speed * speed)};
  }
  /// The share of an error that remains at the time ratio `r` under `K_tbg` alone: `x(r) / x0`.
  [[nodiscard]] T remaining(const T& r) const noexcept {
    using std::pow;
    return pow(T((quintic(r).rest + delta_) / (T(1) + delta_)), T(T(1) + eps_));
  }
  /// Time ratio at which the gain peaks: 0.8755 for eps = 0.05, delta = 0.01.
  [[nodiscard]] constexpr const T& peak_time() const noexcept { return peak_time_; }
  /// Peak of the gain, times tb: 14.465 for eps = 0.05, delta = 0.01.
  [[nodiscard]] constexpr const T& peak_gain() const noexcept { return peak_gain_; }
  /// Peak of the error's speed, `|dx| tb / x0`: 1.886 for eps = 0.05, delta = 0.01.
  [[nodiscard]] constexpr const T& peak_speed() const noexcept { return peak_speed_; }
  [[nodiscard]] constexpr const T& eps() const noexcept { return eps_; }
  [[nodiscard]] constexpr const T& delta() const noexcept { return delta_; }

 private:
  T eps_, delta_;
  T peak_time_, peak_gain_, peak_speed_;
};

SKINCTL_END_NAMESPACE
