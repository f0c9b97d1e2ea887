// Time: whole nanoseconds, so that a day of cycles loses nothing.
#pragma once

#include <cstdint>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A point in time or a duration [ns]. All stamps of one scene count from the same instant of one clock.
using Nanoseconds = std::int64_t;

inline constexpr Nanoseconds operator""_s(unsigned long long s) {
  return static_cast<Nanoseconds>(s) * 1'000'000'000;
}
inline constexpr Nanoseconds operator""_ms(unsigned long long ms) {
  return static_cast<Nanoseconds>(ms) * 1'000'000;
}
inline constexpr Nanoseconds operator""_us(unsigned long long us) {
  return static_cast<Nanoseconds>(us) * 1'000;
}
inline constexpr Nanoseconds operator""_ns(unsigned long long ns) {
  return static_cast<Nanoseconds>(ns);
}

/// A duration in seconds. Differences of stamps are taken before the conversion: exact to 1 ns, then rounded
/// once.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr T seconds(Nanoseconds t) noexcept {
  if constexpr (std::floating_point<T>) {
    return static_cast<T>(static_cast<double>(t) * 1e-9);
  } else {
    return T(static_cast<double>(t)) / T(1e9);
  }
}

/// Seconds to the nearest nanosecond; for configuration, not for the loop. Beyond +-292 years: the nearest
/// end.
[[nodiscard]] constexpr Nanoseconds nanoseconds(double s) noexcept {
  const double ns = s * 1e9;
  if (!(ns > -9.2e18)) return ns != ns ? 0 : INT64_MIN;
  if (ns >= 9.2e18) return INT64_MAX;
  return static_cast<Nanoseconds>(ns < 0 ? ns - 0.5 : ns + 0.5);
}

SKINCTL_END_NAMESPACE
