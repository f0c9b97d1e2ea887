// SPDX-License-Identifier: BSD-3-Clause
// The quintic from 0 to 1, at rest at both ends: the shape of splines, time bases and ramps.
#pragma once

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Peak of `a2 tf`: the largest speed of a quintic over the mean speed, at r = 1/2.
template <Real T>
inline const T quintic_peak_speed = T(1.875);
/// Peak of `|a3| tf^2`: the largest acceleration of a quintic over its length and squared duration,
/// `10 / sqrt(3)`, at r = 1/2 -+ sqrt(3)/6.
template <Real T>
inline const T quintic_peak_acceleration = T(5.773502691896257645L);

/// The polynomial of eq. (22) and its derivatives at one instant.
template <Real T = double>
struct Quintic {
  T a1;    ///< `10 r^3 - 15 r^4 + 6 r^5`, the part of the path covered, 0 to 1
  T rest;  ///< `1 - a1`, the part that remains, without cancellation
  T a2;    ///< rate of the covered part, `da1/dt` [1/s]
  T a3;    ///< second derivative of the covered part, `da2/dt` [1/s^2]

  friend SKINCTL_INLINE constexpr Quintic operator+(const Quintic& a, const Quintic& b) noexcept {
    return {a.a1 + b.a1, a.rest + b.rest, a.a2 + b.a2, a.a3 + b.a3};
  }
};

/// The quintic at the time ratio `r = t / tf`, with derivatives for `1 / tf` given as `rate` [1/s] (1: by r).
///
/// `r` is clamped to [0, 1]; a NaN counts as 1, the end. Velocity and acceleration are exact zeros at both
/// ends. `a1` never decreases with `r`, in every type, and `a1(r) + a1(1 - r) = 1`: it is folded about r =
/// 1/2 and, with `t = r (1 - r)`, summed as `r (10 t^2 + r^2 (5 t + r^2))`. There every factor and summand
/// grows with r, and rounding keeps that order; the printed form is a difference and does not keep it.
/// Relative error of all four: a few units in the last place.
template <Real T>
[[nodiscard]] SKINCTL_INLINE constexpr Quintic<T> quintic(T r, const T& rate = T(1)) noexcept {
  if (!(r < T(1))) return {T(1), T(0), T(0), T(0)};
  if (!(r > T(0))) return {T(0), T(1), T(0), T(0)};
  const bool late = r > T(0.5);
  const T s = late ? T(T(1) - r) : r;  // exact for r > 1/2
  const T middle = T(0.5) - s;
  // s (1 - s), each branch where its rounded value grows with s
  const T t = s < T(0.25) ? T(s - s * s) : T(T(0.25) - middle * middle);
  const T square = s * s;
  const T near_end = s * (T(10) * (t * t) + square * (T(5) * t + square));
  const T far_end = T(1) - near_end;
  const T bend = T(120) * rate * rate * t * middle;
  return {late ? far_end : near_end, late ? near_end : far_end, T(30) * rate * (t * t),
          late ? T(-bend) : bend};
}

/// The part of a quintic of `tf` seconds by which it begins in motion: `tf p rate + tf^2 b bend` with
/// `p = r - 6 r^3 + 8 r^4 - 3 r^5` and `b = r^2 (1 - r)^3 / 2`, and its derivatives. It is zero at the end.
template <Real T = double>
struct MovingStart {
  T rate = T(0);  ///< initial rate of the covered part, da1/dt [1/s]
  T bend = T(0);  ///< derivative of `rate` [1/s^2]

  /// The start of a motion over the distance `d` with the velocity `v` and the acceleration `a`: as much of
  /// them as does not lead beyond the goal, and nothing of a motion away from it.
  [[nodiscard]] static constexpr MovingStart along(const T& d, const T& v, const T& a, const T& tf) noexcept {
    if (!(d * v > T(0)) || !(tf > T(0))) return {};
    const T rate = v / d, most = T(2.5) / tf;  // a1 grows all the way up to that
    if (rate > most) return {most, T(0)};
    const T bend = a / d, limit = T(5) / (tf * tf);
    return {rate, bend > limit ? limit : (bend < -limit ? T(-limit) : bend)};
  }
  [[nodiscard]] SKINCTL_INLINE Quintic<T> at(const T& r, const T& tf) const noexcept {
    if (!(r < T(1)) || !(r > T(0))) return {T(0), T(0), r == T(0) ? rate : T(0), r == T(0) ? bend : T(0)};
    const T rest = T(1) - r, square = rest * rest;
    const T p = r * rest * square * (T(1) + T(3) * r), b = T(0.5) * r * r * rest * square;
    const T dp = square * (T(1) + r * (T(2) - T(15) * r)), db = T(0.5) * r * square * (T(2) - T(5) * r);
    const T ddp = r * (r * (T(96) - T(60) * r) - T(36)), ddb = T(1) - r * (T(9) - r * (T(18) - T(10) * r));
    const T a1 = tf * (p * rate + tf * b * bend);
    return {a1, T(-a1), dp * rate + tf * db * bend, ddp * rate / tf + ddb * bend};
  }
};

SKINCTL_END_NAMESPACE
