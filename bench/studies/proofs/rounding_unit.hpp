// What one rounding, one constant and one kernel may be off, in float and in double.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
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

/// Half a unit in the last place of the numbers of magnitude up to `most`: what rounding to nearest changes
/// of a result in that range. The smallest normal number is added for underflow, also if that goes to zero.
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

/// The ends of the intervals of magnitudes by which the error of a sine or cosine is given.
inline constexpr std::size_t turning_steps = 9;
inline constexpr double turning_ends[turning_steps + 1] = {0,      0.1247, 0.2475, 0.4795, 0.6052,
                                                           0.7070, 0.7962, 0.8776, 0.9690, 1};
constexpr double turning_error(const double (&error)[turning_steps], double low, double high) noexcept {
  double most = 0;
  for (std::size_t i = 0; i < turning_steps; ++i)
    if (low <= turning_ends[i + 1] + 0.0005 && high >= turning_ends[i] - 0.0005 && error[i] > most)
      most = error[i];
  return most;
}

/// Absolute errors of `math::sincos` and `math::tanh`, policy Fast, with fused products or without: proven by
/// Gappa and Sollya in `tests/math/kernels_test.cpp`. `turning` is that of sines and cosines by their
/// magnitude. Beyond the kernel's limit, where the C library computes, the same is assumed.
template <class R>
struct kernel_error;
template <>
struct kernel_error<double> {
  static constexpr double sine = 2.1e-16, cosine = 2.1e-16, tanh = 2.9e-16;
  static constexpr double turning[turning_steps] = {2.9e-17,  4.4e-17,  9.0e-17,  1.71e-16, 1.74e-16,
                                                    2.10e-16, 1.65e-16, 1.04e-16, 6.8e-17};
};
template <>
struct kernel_error<float> {
  static constexpr double sine = 1.13e-7, cosine = 1.13e-7, tanh = 1.54e-7;
  static constexpr double turning[turning_steps] = {1.18e-8, 1.63e-8, 4.9e-8, 9.3e-8, 9.5e-8,
                                                    1.13e-7, 8.9e-8,  5.6e-8, 3.5e-8};
};

}  // namespace math::detail
SKINCTL_END_NAMESPACE
