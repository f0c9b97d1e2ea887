// Compensated sums for running totals and integrated states.
#pragma once

#include <type_traits>

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

/// As `two_sum`, in three additions, where `|a| >= |b|` or `a` is 0. Dekker 1971.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr Rounded<T> fast_two_sum(const T& a, const T& b) noexcept {
  const T value = a + b;
  return {value, T(b - (value - a))};
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

/// The default: `add_compensated`. Its error is that of rounding each step once more.
struct Compensated {};
/// Twice the digits: ten additions. The error of `value + rest` is at most `2 n u^2 max|s_k|`, whatever the
/// steps: for states that oscillate for days, or terms that cancel. Joldes, Muller, Popescu 2017, algorithm
/// 4.
struct DoubleWord {};
/// No error at all, and the same sum in any order: a fixed-point number as wide as the type's whole range
/// (96 bytes for float, 552 for double). `skinctl/math/exact_sum.hpp`.
struct Exact {};

/// A running total of `T`, or of lanes: `Sum<float> q(start); q += h * dq; use(q.value());`
///
/// A member of memories: trivially copyable, zero by default. `value()` is the total rounded to `T`. A NaN,
/// an infinite term or an overflow makes it not finite for good.
template <Scalar T = double, class Policy = Compensated>
class Sum {
  static_assert(std::is_same_v<Policy, Compensated> || std::is_same_v<Policy, DoubleWord>,
                "Sum<T, Policy>: Compensated, DoubleWord, or Exact with skinctl/math/exact_sum.hpp");

 public:
  constexpr Sum() noexcept = default;
  SKINCTL_INLINE constexpr explicit Sum(const T& start) noexcept : value_(start) {}

  SKINCTL_INLINE constexpr Sum& operator+=(const T& x) noexcept {
    if constexpr (std::is_same_v<Policy, Compensated>) {
      add_compensated(value_, rest_, x);
    } else {
      const Rounded<T> sum = two_sum(value_, x);
      const Rounded<T> total = fast_two_sum(sum.value, T(rest_ + sum.error));
      value_ = total.value;
      rest_ = total.error;
    }
    return *this;
  }
  SKINCTL_INLINE constexpr Sum& operator-=(const T& x) noexcept { return *this += T(-x); }

  [[nodiscard]] SKINCTL_INLINE constexpr const T& value() const noexcept { return value_; }
  /// The part of the total that `value()` lacks, at most half a unit in its last place.
  [[nodiscard]] SKINCTL_INLINE constexpr const T& rest() const noexcept { return rest_; }

 private:
  T value_{0};
  T rest_{0};
};

}  // namespace math
SKINCTL_END_NAMESPACE
