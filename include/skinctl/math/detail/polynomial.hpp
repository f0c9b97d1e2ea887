// SPDX-License-Identifier: BSD-3-Clause
// A polynomial with constant coefficients.
#pragma once

#include <cstddef>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// Horner, lowest coefficient first. Shorter chains cost more operations and, with FMA, more time.
template <Scalar L, class T, std::size_t N>
[[nodiscard]] SKINCTL_INLINE L polynomial(L z, const T (&coefficients)[N]) noexcept {
  L y(coefficients[N - 1]);
  skinctl::detail::unrolled<N - 1>([&](std::size_t i)
                                       SKINCTL_INLINE_LAMBDA { y = y * z + L(coefficients[N - 2 - i]); });
  return y;
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
