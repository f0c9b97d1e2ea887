// `std::numeric_limits` of a scalar that stands for another one.
#pragma once

#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The limits of `R`, as values of `T`, which is made of an `R` and is no IEEE number itself. For
/// specialisations of `std::numeric_limits` to inherit.
template <class T, class R>
struct LimitsLike {
  using Of = std::numeric_limits<R>;
  static constexpr bool is_specialized = true, is_integer = false, is_signed = true, is_exact = false,
                        has_infinity = true, has_quiet_NaN = true, is_iec559 = false, is_bounded = true;
  static constexpr int digits = Of::digits, digits10 = Of::digits10, max_digits10 = Of::max_digits10,
                       radix = 2, min_exponent = Of::min_exponent, max_exponent = Of::max_exponent,
                       min_exponent10 = Of::min_exponent10, max_exponent10 = Of::max_exponent10;
  static constexpr T epsilon() noexcept { return Of::epsilon(); }
  static constexpr T min() noexcept { return Of::min(); }
  static constexpr T max() noexcept { return Of::max(); }
  static constexpr T lowest() noexcept { return Of::lowest(); }
  static constexpr T infinity() noexcept { return Of::infinity(); }
  static constexpr T quiet_NaN() noexcept { return Of::quiet_NaN(); }
  static constexpr T denorm_min() noexcept { return Of::denorm_min(); }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
