// Sine and cosine: of one number, of lanes, of the joints of a robot at once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "skinctl/core/lane.hpp"
#include "skinctl/core/real.hpp"
#include "skinctl/math/detail/row_blocks.hpp"
#include "skinctl/math/detail/sincos_kernel.hpp"
#include "skinctl/math/policy.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// Sine and cosine of the same angle.
template <Scalar T>
struct SinCos {
  T sin;
  T cos;
};

/// Sine and cosine of `x` [rad], any x.
///
/// `Fast` takes up to |x| = 1e6 (800 in float) a polynomial that errs by at most 2.5 units in the last place
/// of the result, 2e-16 (1.1e-7 in float); where the result nearly vanishes at large x, 2e-31 (4e-14 in
/// float) comes on top. Beyond, it calls the standard library, which is exact there too but slower: unwrapped
/// angles cost time, not accuracy. NaN and infinity give NaN; sin(-0) is -0. Lanes do not depend on each
/// other. Other reals than float and double call their own sin and cos.
template <class Policy = Fast, Scalar T>
[[nodiscard]] SKINCTL_INLINE SinCos<T> sincos(const T& x) noexcept {
  if constexpr (is_lane<T>) {
    using Real = RealOf<T>;
    constexpr std::size_t W = T::lanes;
    Real angles[W], sines[W], cosines[W];
    if constexpr (std::is_same_v<Policy, Libm>) {
      x.store(angles);
      for (std::size_t i = 0; i < W; ++i) sines[i] = std::sin(angles[i]), cosines[i] = std::cos(angles[i]);
      return {T::load(sines), T::load(cosines)};
    } else {
      SinCos<T> y;
      detail::sincos_kernel(x, y.sin, y.cos);
      if (any(abs(x) > T(detail::SinCosTable<Real>::limit))) [[unlikely]] {
        x.store(angles), y.sin.store(sines), y.cos.store(cosines);
        detail::sincos_beyond(angles, sines, cosines, W);
        return {T::load(sines), T::load(cosines)};
      }
      return y;
    }
  } else if constexpr (detail::has_kernel<T> && !std::is_same_v<Policy, Libm>) {
    const auto y = sincos(Lane<T, detail::narrow_lanes<T>>(x));
    return {y.sin[0], y.cos[0]};
  } else {
    using std::sin, std::cos;
    return {sin(x), cos(x)};
  }
}

/// Sines and cosines of `N` angles, such as a robot's joints, as many at once as the target's registers hold.
/// The outputs may not overlap the angles.
template <std::size_t N, class Policy = Fast, Scalar T>
SKINCTL_INLINE void sincos(const T* x, T* sin, T* cos) noexcept {
  if constexpr (!detail::has_kernel<T> || std::is_same_v<Policy, Libm> || N == 1) {
    for (std::size_t i = 0; i < N; ++i) {
      const SinCos<T> y = sincos<Policy>(x[i]);
      sin[i] = y.sin;
      cos[i] = y.cos;
    }
  } else if constexpr (constexpr std::size_t W = detail::row_lanes<T, N>; N < W) {
    T angles[W] = {}, sines[W], cosines[W];
    for (std::size_t i = 0; i < N; ++i) angles[i] = x[i];
    sincos<W>(angles, sines, cosines);
    for (std::size_t i = 0; i < N; ++i) sin[i] = sines[i], cos[i] = cosines[i];
  } else {
    using L = Lane<T, W>;
    L largest(T(0));
    detail::for_each_block<T, N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const L angle = L::load(x + i);
      L s, c;
      detail::sincos_kernel(angle, s, c);
      s.store(sin + i);
      c.store(cos + i);
      largest = max(largest, abs(angle));
    });
    if (any(largest > L(detail::SinCosTable<T>::limit))) [[unlikely]]
      detail::sincos_beyond(x, sin, cos, N);
  }
}

/// Sines and cosines of an array of angles; the outputs may not be the angles.
template <class Policy = Fast, Scalar T, std::size_t N>
SKINCTL_INLINE void sincos(const std::array<T, N>& x, std::array<T, N>& sin, std::array<T, N>& cos) noexcept {
  sincos<N, Policy>(x.data(), sin.data(), cos.data());
}

}  // namespace math
SKINCTL_END_NAMESPACE
