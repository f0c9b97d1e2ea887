// SPDX-License-Identifier: BSD-3-Clause
// Functions of an angle for exp and log of a rotation, accurate at every length of the rotation vector.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/core/triple.hpp"
#include "skinctl/frames/detail/rotation_kernel.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <Real T>
struct ExpFactors {
  T sine;    ///< sin(a) / a
  T cosine;  ///< (1 - cos(a)) / a^2
};
/// The factors of exp from the half angle: one sine and cosine, and no cancellation.
template <Real T>
[[nodiscard]] SKINCTL_NOINLINE ExpFactors<T> exp_factors_beyond(const Xyz<T>& phi) noexcept {
  using std::cos;
  using std::sin;
  const T half = T(0.5) * norm(phi);
  if (half == T(0)) return {T(1), T(0.5)};
  const T s = sin(half) / half;
  return {s * cos(half), T(0.5) * s * s};
}
/// The factors of exp, by polynomials up to half a turn.
template <Real T>
[[nodiscard]] SKINCTL_INLINE ExpFactors<T> exp_factors(const Xyz<T>& phi) noexcept {
  if constexpr (math::detail::has_kernel<T>) {
    const T square = T(0.25) * dot(phi, phi);
    if (square <= sinc_cos_limit<T>) [[likely]] {
      T s, c;
      sinc_cos(square, s, c);
      return {s * c, T(0.5) * s * s};
    }
  }
  return exp_factors_beyond(phi);
}

/// Number of terms of the alternating series below that reach the rounding error of `T` for arguments up to
/// 1: their k-th term is smaller than 1 / (2k)!.
template <Real T>
[[nodiscard]] constexpr int series_terms() noexcept {
  int k = 1;
  for (int bits = 1; bits < std::numeric_limits<T>::digits + 2; ++k)
    for (int product = (2 * k + 1) * (2 * k + 2); product >= 2; product /= 2) ++bits;
  return k;
}

/// `(a - sin(a)) / a^3` for `a = |phi|`; 1/6 at 0.
template <Real T>
[[nodiscard]] T cubic_factor(const Xyz<T>& phi) noexcept {
  using std::sin;
  const T a = norm(phi);
  if (a > T(1)) return T((a - sin(a)) / (a * a * a));
  const T square = a * a;
  T sum(1);
  for (int k = series_terms<T>(); k > 0; --k) sum = T(1) - sum * square / T((2 * k + 2) * (2 * k + 3));
  return T(sum / T(6));
}

/// `(1 - (a/2) cot(a/2)) / a^2` for `a = |phi|`; 1/12 at 0. With h = a/2 it is
///
///     ((sin h - h cos h) / h^3) / (4 sin(h) / h),
///
/// whose numerator has a series without cancellation.
template <Real T>
[[nodiscard]] T inverse_factor(const Xyz<T>& phi) noexcept {
  using std::cos;
  using std::sin;
  const T h = T(0.5) * norm(phi);
  if (h == T(0)) return T(T(1) / T(12));
  const T sinc = sin(h) / h;
  const T square = h * h;
  if (h > T(1)) return T((sinc - cos(h)) / (square * T(4) * sinc));
  // sum of (-1)^(k+1) 2k h^(2k-2) / (2k+1)!, whose terms have the ratio -h^2 / (2k (2k+3))
  T sum(1);
  for (int k = series_terms<T>(); k > 0; --k) sum = T(1) - sum * square / T((2 * k) * (2 * k + 3));
  return T(sum / (T(12) * sinc));
}

template <Real T>
struct Quaternion {
  T w;
  Xyz<T> v;
};

/// The unit quaternion of three axes, `w >= 0`, divided by a component of at least 1/2 (Shepperd 1978), never
/// by a small number.
template <Real T>
[[nodiscard]] Quaternion<T> unit_quaternion(const Xyz<T>& x, const Xyz<T>& y, const Xyz<T>& z) noexcept {
  using std::sqrt;
  const Xyz<T> odd{y.z - z.y, z.x - x.z, x.y - y.x};
  const T ww = x.x + y.y + z.z;
  Quaternion<T> q;
  if (ww > T(0)) {
    q = {T(1) + ww, odd};
  } else if (x.x >= y.y && x.x >= z.z) {
    q = {odd.x, {T(1) + x.x - y.y - z.z, x.y + y.x, z.x + x.z}};
  } else if (y.y >= z.z) {
    q = {odd.y, {x.y + y.x, T(1) + y.y - x.x - z.z, y.z + z.y}};
  } else {
    q = {odd.z, {z.x + x.z, y.z + z.y, T(1) + z.z - x.x - y.y}};
  }
  const T scale = (q.w < T(0) ? T(-1) : T(1)) / sqrt(q.w * q.w + dot(q.v, q.v));
  return {T(scale * q.w), scale * q.v};
}

template <Real T>
[[nodiscard]] Xyz<T> shortest_rotation_vector(const Quaternion<T>& q) noexcept {
  using std::atan2;
  const T s = norm(q.v);
  if (s == T(0)) return {T(0), T(0), T(0)};
  return T(T(2) * atan2(s, q.w) / s) * q.v;
}

template <Real T>
[[nodiscard]] Xyz<T> nearer_rotation_vector(const Xyz<T>& phi, const Xyz<T>& near) noexcept {
  using std::atan2;
  const T a = norm(phi);
  if (a == T(0)) return phi;
  const T turn = T(8) * atan2(T(1), T(1));
  const Xyz<T> other = T((a - turn) / a) * phi;
  const Xyz<T> d = phi - near;
  const Xyz<T> e = other - near;
  return dot(e, e) < dot(d, d) ? other : phi;
}

/// Square of the length [rad^2] beyond which products of the factors and the vector lose digits or overflow.
template <class T>
[[nodiscard]] SKINCTL_INLINE constexpr T far_around() noexcept {
  return std::numeric_limits<T>::max_exponent10 < 100 ? T(1e18) : T(1e150);
}

/// Unit vector along `phi` and its length, however long; NaN for an infinity or a NaN.
template <Real T>
struct AxisAngle {
  Xyz<T> axis;
  T angle;
};
template <Real T>
[[nodiscard]] SKINCTL_NOINLINE AxisAngle<T> turn_of(const Xyz<T>& phi) noexcept {
  T most(0);
  for (const T& x : {phi.x, phi.y, phi.z}) {
    const T size = x < T(0) ? T(-x) : x;
    if (!(size <= most)) most = size;
  }
  const Xyz<T> part{phi.x / most, phi.y / most, phi.z / most};
  const T length = norm(part);
  return {Xyz<T>{part.x / length, part.y / length, part.z / length}, most * length};
}
/// The rotation vector of the same rotation with at most half a turn.
template <Real T>
[[nodiscard]] SKINCTL_NOINLINE Xyz<T> within_a_turn(const Xyz<T>& phi) noexcept {
  using std::atan2, std::cos, std::sin;
  const auto [axis, angle] = turn_of(phi);
  return T(atan2(T(sin(angle)), T(cos(angle)))) * axis;
}
template <Real T>
[[nodiscard]] SKINCTL_NOINLINE Xyz<T> left_jacobian_far_around(const Xyz<T>& phi,
                                                               const Xyz<T>& dphi) noexcept {
  using std::cos, std::sin;
  const auto [axis, angle] = turn_of(phi);
  const Xyz<T> once = cross(axis, dphi);
  return dphi + T((T(1) - cos(angle)) / angle) * once + T(T(1) - sin(angle) / angle) * cross(axis, once);
}
}  // namespace detail
SKINCTL_END_NAMESPACE
