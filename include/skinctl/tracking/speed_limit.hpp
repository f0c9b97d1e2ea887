// SPDX-License-Identifier: BSD-3-Clause
// A reference motion of the joints that keeps below their largest speeds without a kink.
#pragma once

#include <cmath>

#include "skinctl/core/detail/row.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// `limit_speed` far beyond the limits, where eighth powers overflow: all is computed over the largest ratio.
template <std::size_t N, Real T>
SKINCTL_COLD void limit_far_speed(const JointVelocity<N, T>& limit, JointVelocity<N, T>& v,
                                  JointAcceleration<N, T>& a) noexcept {
  using std::sqrt;
  T most(0), y(0), dy(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T x = v[i] / limit[i], size = x < T(0) ? T(-x) : x;
    if (size > most) most = size;
  }
  for (std::size_t i = 0; i < N; ++i) {
    const T x = v[i] / limit[i] / most, x2 = x * x, x4 = x2 * x2;
    y = y + x4 * x4;
    dy = dy + x4 * x2 * x * (a[i] / limit[i] / most);
  }
  const T f = T(1) / sqrt(sqrt(sqrt(y)));
  for (std::size_t i = 0; i < N; ++i) {
    v[i] = f * (v[i] / most);
    a[i] = f * (a[i] / most) - dy / y * v[i];
  }
}
/// Sum y of eighth powers (see `limit_speed`) up to which a speed is unchanged: three quarters of its limit
/// for one joint, half for 25 at once.
inline constexpr double free_sum = 0.1;
/// Sum y of eighth powers (see `limit_speed`) beyond which terms leave the range of float.
inline constexpr double far_sum = 1e30;
}  // namespace detail

/// Slows a motion down along its own direction, `v <- f v`, so that no joint exceeds its limit:
/// `f = h(y)^(-1/8)`, `y = sum (v_i / limit_i)^8`, h = 1 up to y = 0.1, then a parabola into h = y. Below
/// three quarters of the limits v is unchanged to the bit. The acceleration follows as the true derivative. A
/// NaN gives NaNs. Returns whether v was changed.
template <std::size_t N, Real T = double>
SKINCTL_NOINLINE bool limit_speed(const JointVelocity<N, T>& limit, JointVelocity<N, T>& v,
                                  JointAcceleration<N, T>& a) noexcept {
  T y(0), dy(0);
  for (std::size_t i = 0; i < N; ++i) {
    const T x = v[i] / limit[i];
    const T x2 = x * x, x4 = x2 * x2;
    y = y + x4 * x4;
    dy = dy + T(8) * x4 * x2 * x * (a[i] / limit[i]);
  }
  if (y <= T(detail::free_sum)) [[likely]]
    return false;
  using std::sqrt;
  const T w = T(1 - detail::free_sum);
  const T over = y - T(detail::free_sum);
  const bool far = !(y < T(1) + w);
  if (!(y < T(detail::far_sum))) [[unlikely]] {
    detail::limit_far_speed(limit, v, a);
    return true;
  }
  const T h = far ? y : T(T(1) + over * over / (T(4) * w));
  const T dh = far ? dy : T(over / (T(2) * w) * dy);
  const T f = T(1) / sqrt(sqrt(sqrt(h)));
  const T df = T(-0.125) * f * dh / h;
  for (std::size_t i = 0; i < N; ++i) {
    a[i] = f * a[i] + df * v[i];
    v[i] = f * v[i];
  }
  return true;
}

/// `limit_speed` of a motion in lanes; up to half of the limits nothing needs to be computed.
template <std::size_t N, Real T>
SKINCTL_INLINE bool limit_speed(const JointVelocity<N, T>& limit, detail::Row<N, T>& v,
                                detail::Row<N, T>& a) noexcept {
  static_assert(double(N) <= detail::free_sum * 256, "up to half of the limits, y = 2^-8 of each joint");
  if (all(magnitude(v) <= T(0.5) * detail::Row<N, T>(limit))) [[likely]]
    return false;
  JointVelocity<N, T> velocity(v);
  JointAcceleration<N, T> acceleration(a);
  const bool changed = limit_speed(limit, velocity, acceleration);
  v = velocity, a = acceleration;
  return changed;
}

SKINCTL_END_NAMESPACE
