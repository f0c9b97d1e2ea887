// SPDX-License-Identifier: BSD-3-Clause
// Time in whole nanoseconds, so that sums over a day of cycles are exact.
#pragma once

#include <cstdint>
#include <limits>
#include <version>

#if defined(__GLIBCXX__) && __has_include(<bits/chrono.h>)
#include <bits/chrono.h>  // durations only: <chrono> costs 0.2 s and 40 MB a file
#else
#include <chrono>
#endif

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `8ms`, `2s`, `100us`: durations are written as the standard library writes them.
using namespace std::chrono_literals;

/// A point in time or a duration. All stamps of one scene count from the same instant of one clock.
using Nanoseconds = std::chrono::nanoseconds;

/// A duration in seconds. Differences of stamps are taken before the conversion: exact to 1 ns, then rounded
/// once.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr T seconds(Nanoseconds t) noexcept {
  if constexpr (std::floating_point<T>) {
    return static_cast<T>(static_cast<double>(t.count()) * 1e-9);
  } else {
    return T(static_cast<double>(t.count())) / T(1e9);
  }
}

/// Seconds to the nearest nanosecond; for configuration, not for the loop. Beyond +-292 years: the nearest
/// end; NaN: 0.
[[nodiscard]] constexpr Nanoseconds nanoseconds(double s) noexcept {
  const double ns = s * 1e9;
  if (!(ns > -9.2e18)) return ns != ns ? Nanoseconds{} : Nanoseconds::min();
  if (ns >= 9.2e18) return Nanoseconds::max();
  return Nanoseconds(static_cast<std::int64_t>(ns < 0 ? ns - 0.5 : ns + 0.5));
}

/// A duration in milliseconds, for messages.
[[nodiscard]] constexpr double milliseconds(Nanoseconds t) noexcept {
  return static_cast<double>(t.count()) * 1e-6;
}

/// See recording/each_number.hpp: a duration is a whole number of nanoseconds.
template <class F>
void each_number(Nanoseconds& t, F&& f) {
  std::int64_t count = t.count();
  f(count);
  t = Nanoseconds(count);
}

SKINCTL_END_NAMESPACE
