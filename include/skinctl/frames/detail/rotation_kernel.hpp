// SPDX-License-Identifier: BSD-3-Clause
// Polynomials for exp of a turn up to half a turn, and for log of a small one: no square root, no library
// call.
#pragma once

#include <limits>

#include "skinctl/math/detail/polynomial.hpp"
#include "skinctl/math/detail/row_blocks.hpp"
#include "skinctl/math/detail/sincos_kernel.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Polynomials in `u = tan(a / 2)^2`, by type: `atan` for `(a / 2) / tan(a / 2)`, and `bend` for
/// `(1 - (a/2) cot(a/2)) / a^2`. Minimax for a up to 0.5, rounded coefficient by coefficient.
template <class T>
struct SmallTurn;
/// Relative error of `atan` 2^-60, of `bend` 2^-54.
template <>
struct SmallTurn<double> {
  static constexpr double limit = 0.0652;
  static constexpr double atan[] = {0x1.0000000000000p+0,  -0x1.5555555555550p-2, 0x1.999999999850dp-3,
                                    -0x1.2492492395116p-3, 0x1.c71c7100cc1d0p-4,  -0x1.745cea949a716p-4,
                                    0x1.3b0d8a7664595p-4,  -0x1.108a24d36b903p-4, 0x1.d3bfa4ffedffap-5,
                                    -0x1.43316e630c930p-5};
  static constexpr double bend[] = {0x1.5555555555555p-4,   0x1.6c16c16c16b1ap-8,   -0x1.a01a019fe739bp-9,
                                    0x1.1ea5d37c5bd87p-9,   -0x1.b13194dbbed69p-10, 0x1.59f9fbb2ef953p-10,
                                    -0x1.1e68b263dba93p-10, 0x1.dd1ee24bd6c5bp-11,  -0x1.4927751e0955fp-11};
};
/// Relative error of `atan` 2^-31, of `bend` 2^-25.
template <>
struct SmallTurn<float> {
  static constexpr float limit = 0.0652f;
  static constexpr float atan[] = {0x1.000000p+0f, -0x1.55554cp-2f, 0x1.99908cp-3f, -0x1.2307fcp-3f,
                                   0x1.8f80e0p-4f};
  static constexpr float bend[] = {0x1.555556p-4f, 0x1.6c150ap-8f, -0x1.9f0ec6p-9f, 0x1.045d6ap-9f};
};

/// `sin(h) / h` and `cos h` for `square = h^2` up to (pi/4)^2.
template <Real T>
SKINCTL_INLINE void sinc_cos(const T& square, T& sinc, T& cos) noexcept {
  using Table = math::detail::SinCosTable<T>;
  sinc = T(1) + square * math::detail::polynomial(square, Table::sin);
  cos = T(1) + square * math::detail::polynomial(square, Table::cos);
}
/// The largest `square` that `sinc_cos` takes.
template <Real T>
inline constexpr T sinc_cos_limit = T(0.6168502750680849L);

}  // namespace detail
SKINCTL_END_NAMESPACE
