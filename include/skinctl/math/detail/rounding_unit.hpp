// What one rounding, one constant and one kernel may be off, in float and in double.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// The largest power of two of at most |x|.
[[nodiscard]] constexpr double power_of_two_below(double x) noexcept {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u);
}
[[nodiscard]] constexpr bool is_power_of_two_or_zero(double x) noexcept {
  return x - x == 0 && power_of_two_below(x) == (x < 0 ? -x : x);
}

/// Half a unit in the last place of the numbers of magnitude up to `most`: what rounding to nearest changes of a
/// result in that range. The smallest normal number is added for underflow, also if that goes to zero.
template <class R>
[[nodiscard]] constexpr double half_ulp(double most) noexcept {
  if (most == 0) return 0;
  if (!(most < static_cast<double>(std::numeric_limits<R>::max())))
    return std::numeric_limits<double>::infinity();
  constexpr double u = 0.5 * static_cast<double>(std::numeric_limits<R>::epsilon());
  return u * power_of_two_below(most) + static_cast<double>(std::numeric_limits<R>::min());
}
/// The error of a constant that the program holds in `R`.
template <class R>
[[nodiscard]] constexpr double constant_error(double x) noexcept {
  if (x - x != 0) return 0;
  const double e = static_cast<double>(static_cast<R>(x)) - x;
  return e < 0 ? -e : e;
}

/// Absolute errors of `math::sincos` and `math::tanh`, policy Fast, on their whole range, as
/// `tests/math/kernels_test` has them proven by Gappa and Sollya.
template <class R>
struct kernel_error;
template <>
struct kernel_error<double> {
  static constexpr double sine = 2.1e-16, cosine = 2.1e-16, tanh = 2.5e-16;
};
template <>
struct kernel_error<float> {
  static constexpr double sine = 1.15e-7, cosine = 1.15e-7, tanh = 1.3e-7;
};

}  // namespace math::detail
SKINCTL_END_NAMESPACE
