// SPDX-License-Identifier: BSD-3-Clause
// A motion that follows a target with jumps, within limits of velocity, acceleration and jerk.
#pragma once

#include <cmath>
#include <cstddef>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Limits of a motion, of the length of its vector, each > 0: [m/s], [m/s^2] and [m/s^3], or in radians.
template <Scalar T = double>
struct PursuitLimits {
  T velocity, acceleration, jerk;
};

/// Throws `ConfigurationError` for limits that are not positive, or beyond 1e6 (jerk: 1e9).
template <Real T>
SKINCTL_COLD void check(const PursuitLimits<T>& l) {
  require(l.velocity > T(0) && l.velocity <= T(1e6), "pursuit: velocity", static_cast<double>(l.velocity),
          "> 0");
  require(l.acceleration > T(0) && l.acceleration <= T(1e6), "pursuit: acceleration",
          static_cast<double>(l.acceleration), "> 0");
  require(l.jerk > T(0) && l.jerk <= T(1e9), "pursuit: jerk", static_cast<double>(l.jerk), "> 0");
}

/// Velocity and acceleration of a motion of `D` coordinates.
template <std::size_t D, Scalar T = double>
struct Pursuit {
  T v[D] = {};
  T a[D] = {};

  /// The distance needed to stop from the speed `v`, [m] or [rad]: the motion brakes with half of the
  /// acceleration and builds that up with the jerk.
  [[nodiscard]] static constexpr T braking_distance(const PursuitLimits<T>& l, const T& v) noexcept {
    return v * v / l.acceleration + v * l.acceleration / l.jerk;
  }

  /// Moves on by `dt` [s]; `moved` becomes the distance covered. Towards a target at the distance `e` that
  /// moves at `v_t`:
  ///
  ///     v* = v_t + V(|e|) e/|e|,  V(e) = (b/k) (sqrt(1 + 2 k^2 e / b) - 1)   (brakes at b, slope k at 0)
  ///     a* = dv*/dt + A(|v* - v|) (v* - v)/|v* - v|,  A the same with the jerk,
  ///
  /// each cut off at its limit: velocity, acceleration and jerk never exceed them, whatever e does. b is half
  /// of the acceleration; k leaves time to build up acceleration within the jerk. For a NaN in e or v_t the
  /// motion brakes.
  SKINCTL_COLD void advance(const T (&e)[D], const T (&v_t)[D], const PursuitLimits<T>& l, const T& dt,
                            T (&moved)[D]) noexcept {
    using std::sqrt;
    const T b = T(0.5) * l.acceleration, b_j = T(0.5) * l.jerk;
    const T slow = T(0.6) * l.jerk / l.acceleration;
    const T k = slow * dt < T(0.05) ? slow : T(T(0.05) / dt);
    const T k_a = T(3) * k;
    const T far = length(e);
    const bool good = far - far == T(0) && length(v_t) - length(v_t) == T(0);
    // Where V is beyond any limit, it may as well be that of this distance.
    const T counted = far < T(1e18) ? far : T(1e18);
    const T root = sqrt(T(1) + T(2) * k * k * counted / b);
    const T speed = b / k * (root - T(1));
    const T slope = k / root;                        // dV/de
    const T part = far > T(0) ? T(speed / far) : k;  // V/e
    T wanted[D], rate[D], along(0);
    if (far > T(0))
      for (std::size_t i = 0; i < D; ++i) along = along + e[i] / far * (v_t[i] - v[i]);
    for (std::size_t i = 0; i < D; ++i) {
      wanted[i] = good ? T(v_t[i] + part * e[i]) : T(0);
      const T across = (v_t[i] - v[i]) - (far > T(0) ? T(along * e[i] / far) : T(0));
      rate[i] = good ? T(part * across + (far > T(0) ? T(slope * along * e[i] / far) : T(0))) : T(0);
    }
    const T top = T(0.97) * l.velocity;
    const T size = length(wanted);
    if (size > top)
      for (std::size_t i = 0; i < D; ++i) wanted[i] = wanted[i] * (top / size), rate[i] = T(0);
    T gap[D];
    for (std::size_t i = 0; i < D; ++i) gap[i] = wanted[i] - v[i];
    const T g = length(gap);
    const T push = b_j / k_a * (sqrt(T(1) + T(2) * k_a * k_a * g / b_j) - T(1));
    for (std::size_t i = 0; i < D; ++i) rate[i] = rate[i] + (g > T(0) ? T(push * gap[i] / g) : T(0));
    cut(rate, l.acceleration);
    T da[D];
    const T quick = T(0.5) / dt;
    for (std::size_t i = 0; i < D; ++i) da[i] = quick * (rate[i] - a[i]);
    cut(da, l.jerk);
    for (std::size_t i = 0; i < D; ++i) {
      const T a_next = a[i] + dt * da[i];
      moved[i] = dt * (v[i] + dt * (T(0.5) * a[i] + dt * da[i] * T(1) / T(6)));
      v[i] = v[i] + T(0.5) * dt * (a[i] + a_next);
      a[i] = a_next;
    }
  }

 private:
  [[nodiscard]] static T length(const T (&x)[D]) noexcept {
    using std::sqrt;
    T square(0);
    for (const T& y : x) square = square + y * y;
    if (square - square == T(0)) [[likely]]
      return sqrt(square);
    T most(0), ratios(0);  // too far or too fast for a square
    for (const T& y : x) {
      const T size = y < T(0) ? T(-y) : y;
      if (!(size <= most)) most = size;
    }
    for (const T& y : x) ratios = ratios + (y / most) * (y / most);
    return most * sqrt(ratios);
  }
  static void cut(T (&x)[D], const T& most) noexcept {
    const T size = length(x);
    if (size > most)
      for (T& y : x) y = y * (most / size);
  }
};

SKINCTL_END_NAMESPACE
