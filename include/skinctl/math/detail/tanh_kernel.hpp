// SPDX-License-Identifier: BSD-3-Clause
// The hyperbolic tangent of a lane.
#pragma once

#include <cmath>
#include <cstddef>

#include "skinctl/core/lane.hpp"
#include "skinctl/math/detail/polynomial.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// Constants by type. `half_ln2` is ln(2) / 2 in two parts, the first so short that its product with k is
/// exact. The polynomial is minimax on |h| <= 0.1734, rounded coefficient by coefficient:
/// `tanh h = h + h^3 p(h^2)`.
template <class T>
struct TanhTable;

/// Relative error of the polynomial 2^-57.7.
template <>
struct TanhTable<double> {
  static constexpr double saturated = 20;  ///< 1 - tanh is 8e-18 here
  static constexpr double round_to_integer = 0x1.8p52;
  static constexpr int digits_behind_point = 52;
  static constexpr double two_over_ln2 = 0x1.71547652b82fep1;
  static constexpr double half_ln2[] = {0x1.62e42fefa398p-2, 0x1.bcd5e4f1d9ccp-48};
  static constexpr double tanh[] = {-0x1.55555555554bcp-2, 0x1.11111110e08bcp-3,  -0x1.ba1ba1168860fp-5,
                                    0x1.664ec9aad687dp-6,  -0x1.223c6691b31fbp-7, 0x1.c380fd8be21d2p-9};
};

/// Relative error of the polynomial 2^-32.5.
template <>
struct TanhTable<float> {
  static constexpr float saturated = 10;  ///< 1 - tanh is 4e-9 here
  static constexpr float round_to_integer = 0x1.8p23f;
  static constexpr int digits_behind_point = 23;
  static constexpr float two_over_ln2 = 0x1.715476p1f;
  static constexpr float half_ln2[] = {0x1.62e4p-2f, 0x1.7f7d1cp-21f};
  static constexpr float tanh[] = {-0x1.55554ep-2f, 0x1.110594p-3f, -0x1.afd7fap-5f};
};

/// Recomputes all results where the thread does not round to nearest: k is then one off, and h beyond the
/// polynomial's range.
template <class T, std::size_t W>
[[gnu::cold, gnu::noinline]] inline Lane<T, W> tanh_by_library(Lane<T, W> x) noexcept {
  T values[W];
  x.store(values);
  for (T& value : values) value = std::tanh(value);
  return Lane<T, W>::load(values);
}

/// With |x| = k ln(2)/2 + h, a = 2^k and w = tanh h, e^(2|x|) = a (1 + w) / (1 - w), so that
///
///     tanh |x| = ((a - 1) + (a + 1) w) / ((a + 1) + (a - 1) w),
///
/// which is w itself for k = 0. From k = 3 on the division gives the difference to 1 instead: its error
/// shrinks with the slope, and the function stays monotonic.
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE Lane<T, W> tanh_kernel(Lane<T, W> x) noexcept {
  using Table = TanhTable<T>;
  using L = Lane<T, W>;
  const L one(T(1)), two(T(2));
  const L y = min(abs(x), L(Table::saturated));
  const L shifted = y * L(Table::two_over_ln2) + L(Table::round_to_integer);
  const L k = shifted - L(Table::round_to_integer);
  L h = y - k * L(Table::half_ln2[0]);
  h = h - k * L(Table::half_ln2[1]);
  const L z = h * h;
  const L w = h + (h * z) * polynomial(z, Table::tanh);

  const auto exponent = skinctl::detail::to_bits<T, W>(shifted.vector()) << Table::digits_behind_point;
  const auto a_bits = exponent + skinctl::detail::to_bits<T, W>(one.vector());
  const L a = skinctl::detail::to_lane<T, W>(a_bits);
  const auto far = k >= L(T(3));
  const L numerator = select(far, two * w - two, (a + one) * w + (a - one));
  const L denominator = (a - one) * w + (a + one);
  if (any(abs(h) > L(T(0.174)))) [[unlikely]]  // 0.1734 when rounded to nearest
    return tanh_by_library(x);
  return copysign(select(far, one, L(T(0))) + numerator / denominator, x);
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
