// SPDX-License-Identifier: BSD-3-Clause
// Ramps: weights between 0 and 1 that change within a given time, twice continuously differentiable.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/trajectory/quintic.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Clocks of trajectories stop here: later than every end, and small enough that additions cannot overflow.
inline constexpr Nanoseconds clock_end = Nanoseconds::max() / 4;

/// The clock `dt` later, or `clock_end`.
[[nodiscard]] SKINCTL_INLINE constexpr Nanoseconds later(Nanoseconds clock, Nanoseconds dt) noexcept {
  return clock < clock_end - dt ? clock + dt : clock_end;
}

/// A quintic weight over `duration`, twice continuously differentiable in time.
template <Real T = double>
class Ramp {
 public:
  /// @param duration  > 0; throws `ConfigurationError` otherwise.
  explicit Ramp(Nanoseconds duration = 100ms) : duration_(duration) {
    require(duration > 0ns, "duration of a ramp", seconds<double>(duration), "> 0 s");
  }
  [[nodiscard]] constexpr Nanoseconds duration() const noexcept { return duration_; }

  /// Weight of the value that fades in, `elapsed` after the start: 0 before the start, 1 after the end.
  [[nodiscard]] SKINCTL_INLINE constexpr T up(Nanoseconds elapsed) const noexcept {
    return quintic(seconds<T>(elapsed) / seconds<T>(duration_)).a1;
  }
  /// Weight of the value that fades out: `1 - up`.
  [[nodiscard]] SKINCTL_INLINE constexpr T down(Nanoseconds elapsed) const noexcept {
    return quintic(seconds<T>(elapsed) / seconds<T>(duration_)).rest;
  }
  /// Whether the ramp still changes; false at its end and after it.
  [[nodiscard]] SKINCTL_INLINE constexpr bool lasts(Nanoseconds elapsed) const noexcept {
    return elapsed < duration_;
  }

 private:
  Nanoseconds duration_;
};

/// The value between `from` (weight 0) and `to` (weight 1), exactly these at the ends.
template <class V, Real T>
[[nodiscard]] SKINCTL_INLINE constexpr V blend(const V& from, const V& to, const T& weight) noexcept {
  return (T(1) - weight) * from + weight * to;
}

SKINCTL_END_NAMESPACE
