// The clock of a trajectory: it stops and starts again without a jump of the velocity that it drives.
#pragma once

#include "skinctl/core/time.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A trajectory's own time and its derivatives: `d/dt f(t(x)) = rate f'`, `d2/dt2 = rate^2 f'' + bend f'`.
template <Real T = double>
struct OwnTime {
  T t;     ///< [s]
  T rate;  ///< dt/dx
  T bend;  ///< d2t/dx2 [1/s]
};

/// Own time that runs at rate 1 or is stopped; a quintic joins the two rates. Trivially copyable.
template <Real T = double>
struct PlanClock {
  Nanoseconds own{};                     ///< own time now
  Nanoseconds since_change = clock_end;  ///< time since the last `run` or `stop`
  T from = T(1);                         ///< rate at that moment
  T to = T(1);                           ///< rate that it changes to

  /// Own time `x` seconds from now; a change of rate takes `ramp`.
  [[nodiscard]] SKINCTL_INLINE constexpr OwnTime<T> at(const T& x, Nanoseconds ramp) const noexcept {
    if (!(since_change < ramp)) [[likely]]
      return {seconds<T>(own) + x * to, to, T(0)};
    const T begin = seconds<T>(since_change), whole = seconds<T>(ramp);
    const auto way = quintic(T((begin + x) / whole), T(T(1) / whole));
    const T gone = whole * (covered(T((begin + x) / whole)) - covered(T(begin / whole)));
    return {seconds<T>(own) + from * x + (to - from) * gone, from + (to - from) * way.a1,
            (to - from) * way.a2};
  }
  [[nodiscard]] SKINCTL_INLINE constexpr PlanClock advanced(Nanoseconds dt, Nanoseconds ramp) const noexcept {
    if (since_change >= ramp) [[likely]]
      return {later(own, to > T(0) ? dt : 0ns), later(since_change, dt), from, to};
    const T gone = at(seconds<T>(dt), ramp).t - seconds<T>(own);
    return {later(own, nanoseconds(static_cast<double>(gone))), later(since_change, dt), from, to};
  }
  /// Runs or stops from now on, beginning with the present rate.
  [[nodiscard]] SKINCTL_INLINE constexpr PlanClock changed(bool runs, Nanoseconds ramp) const noexcept {
    return {own, 0ns, at(T(0), ramp).rate, runs ? T(1) : T(0)};
  }

 private:
  /// Integral of a1 from 0 to `r`, any r >= 0.
  static SKINCTL_INLINE constexpr T covered(const T& r) noexcept {
    return r < T(1) ? T(r * r * r * r * (T(2.5) - r * (T(3) - r))) : T(r - T(0.5));
  }
};

SKINCTL_END_NAMESPACE
