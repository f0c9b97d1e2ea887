// SPDX-License-Identifier: BSD-3-Clause
// The clock of a trajectory: it stops and starts again without a jump of the velocity that it drives.
#pragma once

#include "skinctl/core/time.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A trajectory's own time and its derivatives: `d/dt f(t(x)) = rate f'`, `d2/dt2 = rate^2 f'' + bend f'`.
template <Real T = double>
struct OwnTime {
  T t;     ///< own time [s]
  T rate;  ///< rate of the own time, dt/dx
  T bend;  ///< derivative of the rate, d2t/dx2 [1/s]
};

/// A trajectory's clock: its own time runs at its pace (1 unless it waits), or is stopped; a quintic joins
/// the two. Trivially copyable.
template <Real T = double>
struct PlanClock {
  Nanoseconds own{};                     ///< own time now
  Nanoseconds since_change = clock_end;  ///< time since the last `run` or `stop`
  T from = T(1);                         ///< rate before the last change, in units of the pace
  T to = T(1);                           ///< rate after the change, in units of the pace
  T pace = T(1);                         ///< rate while it runs, in (0, 1]
  T pace_rate = T(0);  ///< change of the pace [1/s]; 0 while a change of `from` to `to` lasts

  /// Own time `x` seconds from now; a change of rate takes `ramp`.
  [[nodiscard]] SKINCTL_INLINE constexpr OwnTime<T> at(const T& x, Nanoseconds ramp) const noexcept {
    if (!(since_change < ramp)) [[likely]] {
      if (pace == T(1) && pace_rate == T(0)) [[likely]]
        return {seconds<T>(own) + x * to, to, T(0)};
      const T gone = x * (pace + T(0.5) * x * pace_rate);
      return {seconds<T>(own) + gone * to, (pace + x * pace_rate) * to, pace_rate * to};
    }
    const T begin = seconds<T>(since_change), whole = seconds<T>(ramp);
    const auto way = quintic(T((begin + x) / whole), T(T(1) / whole));
    const T gone = whole * (covered(T((begin + x) / whole)) - covered(T(begin / whole)));
    return {seconds<T>(own) + pace * (from * x + (to - from) * gone), pace * (from + (to - from) * way.a1),
            pace * ((to - from) * way.a2)};
  }
  [[nodiscard]] SKINCTL_INLINE constexpr PlanClock advanced(Nanoseconds dt, Nanoseconds ramp) const noexcept {
    const bool even = pace == T(1) && pace_rate == T(0);
    if (since_change >= ramp && even) [[likely]]
      return {later(own, to > T(0) ? dt : 0ns), later(since_change, dt), from, to, pace, pace_rate};
    const T gone = at(seconds<T>(dt), ramp).t - seconds<T>(own);
    return {later(own, nanoseconds(static_cast<double>(gone))),
            later(since_change, dt),
            from,
            to,
            even ? pace : T(pace + seconds<T>(dt) * pace_rate),
            pace_rate};
  }
  /// The clock that runs or stops from now on, beginning with the present rate; the change takes `ramp`.
  [[nodiscard]] SKINCTL_INLINE constexpr PlanClock changed(bool runs, Nanoseconds ramp) const noexcept {
    return {own, 0ns, at(T(0), ramp).rate / pace, runs ? T(1) : T(0), pace, T(0)};
  }
  /// The clock that goes over to the pace `wish`, as a second-order lag does that rests after about `ramp`:
  /// the rate of own time has no step, nor has its derivative but the share of it that belongs to `dt`.
  [[nodiscard]] SKINCTL_INLINE constexpr PlanClock paced(const T& wish, Nanoseconds dt,
                                                         Nanoseconds ramp) const noexcept {
    if (since_change < ramp) return *this;
    const T h = seconds<T>(dt), lag = T(0.25) * seconds<T>(ramp), away = wish - pace;
    const T rate = (lag * lag * pace_rate + h * away) / (lag * lag + h * (T(2) * lag + h));
    const T none = T(1e-6);
    const bool there = away < none && -away < none && rate * lag < none && -rate * lag < none;
    return {own, since_change, from, to, there ? wish : pace, there ? T(0) : rate};
  }

 private:
  /// Integral of the quintic a1 from 0 to `r`, any r >= 0.
  static SKINCTL_INLINE constexpr T covered(const T& r) noexcept {
    return r < T(1) ? T(r * r * r * r * (T(2.5) - r * (T(3) - r))) : T(r - T(0.5));
  }
};

SKINCTL_END_NAMESPACE
