// SPDX-License-Identifier: BSD-3-Clause
// Compensated sums for running totals and integrated states.
#pragma once

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// A number and the rounding error of its computation.
template <Scalar T>
struct Rounded {
  T value;
  T error;
};

/// `a + b` without error: `value` is the rounded sum, `value + error` the exact one, unless `value`
/// overflows. Knuth, The Art of Computer Programming 2, section 4.2.2, theorem B. Six additions; `a` and `b`
/// may have any magnitude.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr Rounded<T> two_sum(const T& a, const T& b) noexcept {
  const T value = a + b;
  const T seen = value - a;
  return {value, T((a - (value - seen)) + (b - seen))};
}

/// Adds `step` to `value + rest`, in seven additions. After n steps x_i with partial sums s_k, and u half a
/// unit in the last place of 1, the error of `value + rest` is at most `u sum|x_i| + n u^2 max|s_k|`, and
/// `|rest|` is at most `u |value|`. Steps of 1e-9 thus add up for days in float, where a plain sum stops
/// growing.
template <Scalar T>
SKINCTL_INLINE constexpr void add_compensated(T& value, T& rest, const T& step) noexcept {
  const Rounded<T> sum = two_sum(value, T(step + rest));
  value = sum.value;
  rest = sum.error;
}

}  // namespace math
SKINCTL_END_NAMESPACE
