// SPDX-License-Identifier: BSD-3-Clause
// A signal over time from its stamped samples: a sum of ramps, their exact integrals, and the parts of an
// interval.
#pragma once

#include <cstdint>

#include "skinctl/core/real.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The times of a sampled signal.
struct SampledTimes {
  Nanoseconds max_age = 50ms;   ///< age of the last sample from which the signal is 0
  Nanoseconds fade = 25ms;      ///< last part of `max_age`, in which the signal goes linearly to 0
  Nanoseconds ramp = 20ms;      ///< longest duration of a change before its sample
  Nanoseconds catch_up = 20ms;  ///< missing impulse before an interval is added up to this time back
  Nanoseconds max_ahead = 2ms;  ///< time after the interval up to which a stamp counts as its end
};

/// `later - earlier` for `later >= earlier`, which never overflows.
SKINCTL_INLINE constexpr std::uint64_t span(Nanoseconds earlier, Nanoseconds later) noexcept {
  return static_cast<std::uint64_t>(later.count()) - static_cast<std::uint64_t>(earlier.count());
}
/// A count of nanoseconds as a duration.
SKINCTL_INLINE constexpr Nanoseconds nanoseconds_of(std::uint64_t count) noexcept {
  return Nanoseconds(static_cast<std::int64_t>(count));
}
/// `later - earlier`; 0 if negative, the longest time if it overflows.
SKINCTL_INLINE constexpr Nanoseconds elapsed(Nanoseconds earlier, Nanoseconds later) noexcept {
  if (later <= earlier) return 0ns;
  const std::uint64_t t = span(earlier, later);
  return t > static_cast<std::uint64_t>(INT64_MAX) ? Nanoseconds::max() : nanoseconds_of(t);
}
/// `t - origin` in seconds, of either sign, for times less than 292 years apart; the difference is taken in
/// integer nanoseconds.
template <Real T>
SKINCTL_INLINE constexpr T seconds_after(Nanoseconds origin, Nanoseconds t) noexcept {
  return seconds<T>(nanoseconds_of(span(origin, t)));
}

/// 0 until `start`, then linear up to 1 within `length` > 0, then 1. All times in seconds from the start of
/// the computed interval, so that they are small.
template <Real T>
class Ramp {
 public:
  SKINCTL_INLINE constexpr Ramp(const T& start, const T& length) noexcept
      : start_(start), length_(length), slope_(T(1) / length) {}

  [[nodiscard]] SKINCTL_INLINE constexpr const T& start() const noexcept { return start_; }
  [[nodiscard]] SKINCTL_INLINE constexpr T value(const T& t) const noexcept { return up(t) * slope_; }
  /// Integral from minus infinity to `t`.
  [[nodiscard]] SKINCTL_INLINE constexpr T integral(const T& t) const noexcept {
    const T beyond = t - start_ - length_;
    const T rise = up(t);
    return T(0.5) * slope_ * rise * rise + (beyond > T(0) ? beyond : T(0));
  }
  /// Integral up to `t` of a signal that follows the ramp until `stop` and is constant afterwards.
  [[nodiscard]] SKINCTL_INLINE constexpr T integral_until(const T& stop, const T& t) const noexcept {
    return t <= stop ? integral(t) : T(integral(stop) + value(stop) * (t - stop));
  }

 private:
  SKINCTL_INLINE constexpr T up(const T& t) const noexcept {
    const T since = t - start_;
    const T risen = since < length_ ? since : length_;
    return risen > T(0) ? risen : T(0);
  }
  T start_;
  T length_;
  T slope_;
};

/// An interval in equal parts; times within it are in seconds from its start.
template <Real T>
struct Parts {
  Nanoseconds from, to;
  std::size_t count;
  T length, per_length, per_whole;  ///< length of a part [s], 1 over it, 1 over the whole [1/s]; 0 without
  T back;                           ///< <= 0: start of the time for which missing impulse is added [s]
  std::uint64_t reach;              ///< length from `back` to the end [ns]

  static Parts of(Nanoseconds from, Nanoseconds to, std::size_t count, Nanoseconds back) noexcept {
    const T whole = seconds<T>(elapsed(from, to)), parts = static_cast<T>(count);
    if (!(whole > T(0))) return {from, from, count, T(0), T(0), T(0), -seconds<T>(back), 0};
    const std::uint64_t length = span(from, to), reach = length + span(0ns, back);
    return {from,
            to,
            count,
            whole / parts,
            parts / whole,
            T(1) / whole,
            -seconds<T>(back),
            reach < length ? ~std::uint64_t(0) : reach};
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
