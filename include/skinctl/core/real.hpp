// SPDX-License-Identifier: BSD-3-Clause
// The scalars: real numbers, and lanes of them.
#pragma once

#include <concepts>
#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A real number type: `float`, `double`, or anything with `std::numeric_limits` that is not an integer, such
/// as `boost::multiprecision::number<..., et_off>` (the oracle of the accuracy tests).
template <class T>
concept Real = std::numeric_limits<T>::is_specialized && !std::numeric_limits<T>::is_integer;

/// True for a type that holds several reals and computes on all of them at once (`Lane`).
template <class T>
inline constexpr bool is_lane = false;

/// True for fixed-point numbers, in which not everything can be computed: specialise it for one of your own.
template <class T>
inline constexpr bool is_fixed_point = false;

/// The scalars of the algorithms: a real or a lane of reals.
template <class T>
concept Scalar = Real<T> || is_lane<T>;

namespace detail {
template <class T>
struct RealOf {
  using type = T;
};

/// |x|, also while compiling; NaN stays NaN.
template <Real T>
[[nodiscard]] SKINCTL_INLINE constexpr T magnitude(const T& x) noexcept {
  return x < T(0) ? T(-x) : x;
}
/// A number whose square is denormal; one below counts as zero, as denormal numbers are slow.
template <Real T>
inline const T dust = T(std::same_as<T, float> ? 1e-17 : 1e-150);
}  // namespace detail

/// The real number inside a scalar: `double` for `double` and for `Lane<double, 4>`.
template <Scalar T>
using RealOf = typename detail::RealOf<T>::type;

/// Relative error that a short chain of operations may leave: 64 units in the last place.
template <Scalar T>
inline const T tolerance = T(64) * std::numeric_limits<RealOf<T>>::epsilon();

SKINCTL_END_NAMESPACE
