// SPDX-License-Identifier: BSD-3-Clause
// Sine and cosine: of one number, of lanes, of the joints of a robot at once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/core/real.hpp"
#include "skinctl/math/detail/row_blocks.hpp"
#include "skinctl/math/detail/sincos_kernel.hpp"
#include "skinctl/math/policy.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {
namespace detail {

/// Sines and cosines of a row.
template <std::size_t N, class T>
SKINCTL_INLINE void sincos_row(const T* x, T* sin, T* cos) noexcept {
  using L = Lane<T, row_lanes<T, N>>;
  using skinctl::detail::unrolled;
  constexpr std::size_t blocks = row_blocks<T, N>;
  L angles[blocks], sines[blocks], cosines[blocks];
  unrolled<blocks>([&](auto i) SKINCTL_INLINE_LAMBDA { angles[i] = L::load(x + row_start<T, N>(i)); });
  sincos_lanes(angles, sines, cosines);
  unrolled<blocks>([&](auto i) SKINCTL_INLINE_LAMBDA {
    sines[i].store(sin + row_start<T, N>(i));
    cosines[i].store(cos + row_start<T, N>(i));
  });
}

}  // namespace detail

/// Sine and cosine of the same angle.
template <Scalar T>
struct SinCos {
  T sin;
  T cos;
};

/// Sine and cosine of `x` [rad], any x.
///
/// `Fast` evaluates a polynomial up to |x| = 1e6 (800 in float). Its error is at most 2.5 units in the last
/// place of the result, and 2.1e-16 (1.13e-7 in float; both proven), plus 2e-31 (4e-14 in float), which
/// matters where the result nearly vanishes at large x. Beyond, it calls the standard library, which is as
/// accurate but slower: unwrapped angles cost time, not accuracy. NaN and infinity give NaN; sin(-0) is -0.
/// Lanes do not depend on each other. Scalars other than float and double call their own sin and cos.
template <class Policy = Fast, Scalar T>
[[nodiscard]] SKINCTL_INLINE SinCos<T> sincos(const T& x) noexcept {
  if constexpr (is_lane<T>) {
    using Real = RealOf<T>;
    constexpr std::size_t W = T::lanes;
    if constexpr (std::is_same_v<Policy, Libm>) {
      Real angles[W], sines[W], cosines[W];
      x.store(angles);
      for (std::size_t i = 0; i < W; ++i) sines[i] = std::sin(angles[i]), cosines[i] = std::cos(angles[i]);
      return {T::load(sines), T::load(cosines)};
    } else {
      T sin[1], cos[1];
      detail::sincos_lanes({x}, sin, cos);
      return {sin[0], cos[0]};
    }
  } else if constexpr (detail::has_kernel<T> && !std::is_same_v<Policy, Libm>) {
    const auto y = sincos(Lane<T, detail::narrow_lanes<T>>(x));
    return {y.sin[0], y.cos[0]};
  } else if constexpr (is_fixed_point<T>) {
    T s, c;
    sin_cos(x, s, c);
    return {s, c};
  } else {
    using std::sin, std::cos;
    return {sin(x), cos(x)};
  }
}

/// Sines and cosines of `N` angles, such as a robot's joints, as many at once as the target's registers hold.
/// The outputs may not overlap the angles.
template <std::size_t N, class Policy = Fast, Scalar T>
SKINCTL_INLINE void sincos(const T* x, T* sin, T* cos) noexcept {
  using skinctl::detail::unrolled;
  if constexpr (std::is_same_v<Policy, Libm> || N == 1 || !(detail::has_kernel<T> || is_lane<T>)) {
    unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const SinCos<T> y = sincos<Policy>(x[i]);
      sin[i] = y.sin;
      cos[i] = y.cos;
    });
  } else if constexpr (is_lane<T>) {
    T sines[N], cosines[N], angles[N];
    unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { angles[i] = x[i]; });
    detail::sincos_lanes(angles, sines, cosines);
    unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { sin[i] = sines[i], cos[i] = cosines[i]; });
  } else if constexpr (constexpr std::size_t W = detail::row_lanes<T, N>; N < W) {
    T angles[W] = {}, sines[W], cosines[W];
    unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { angles[i] = x[i]; });
    sincos<W>(angles, sines, cosines);
    unrolled<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { sin[i] = sines[i], cos[i] = cosines[i]; });
  } else {
    detail::sincos_row<N>(x, sin, cos);
  }
}

/// Sines and cosines of an array of angles; the outputs may not be the angles.
template <class Policy = Fast, Scalar T, std::size_t N>
SKINCTL_INLINE void sincos(const std::array<T, N>& x, std::array<T, N>& sin, std::array<T, N>& cos) noexcept {
  sincos<N, Policy>(x.data(), sin.data(), cos.data());
}

}  // namespace math
SKINCTL_END_NAMESPACE
