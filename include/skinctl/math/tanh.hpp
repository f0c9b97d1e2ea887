// SPDX-License-Identifier: BSD-3-Clause
// The hyperbolic tangent: the smooth sign of control laws.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/math/detail/row_blocks.hpp"
#include "skinctl/math/detail/tanh_kernel.hpp"
#include "skinctl/math/policy.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// tanh x, any x. The error of `Fast` is at most 2.5 units in the last place, also for tiny x; found are
/// 2e-16 (1e-7 in float), proven 2.9e-16 (1.54e-7).
///
/// Odd to the last bit, -0 included. Exactly 1 from 20 on (10 in float) and never beyond; infinity gives 1,
/// NaN gives NaN. Monotonic except for adjacent numbers between 0.17 and 0.9, where the smaller argument may
/// give a result up to two units greater. Scalars other than float and double call their own tanh.
template <class Policy = Fast, Scalar T>
[[nodiscard]] SKINCTL_INLINE T tanh(const T& x) noexcept {
  if constexpr (is_lane<T>) {
    if constexpr (std::is_same_v<Policy, Libm>) {
      RealOf<T> values[T::lanes];
      x.store(values);
      for (auto& value : values) value = std::tanh(value);
      return T::load(values);
    } else {
      return detail::tanh_kernel(x);
    }
  } else if constexpr (detail::has_kernel<T> && !std::is_same_v<Policy, Libm>) {
    return detail::tanh_kernel(Lane<T, detail::narrow_lanes<T>>(x))[0];
  } else {
    using std::tanh;
    return tanh(x);
  }
}

/// `y[i] = tanh x[i]` of `N` numbers, as many at once as the target's registers hold. `y` may not overlap
/// `x`.
template <std::size_t N, class Policy = Fast, Scalar T>
SKINCTL_INLINE void tanh(const T* x, T* y) noexcept {
  if constexpr (!detail::has_kernel<T> || std::is_same_v<Policy, Libm> || N == 1) {
    for (std::size_t i = 0; i < N; ++i) y[i] = tanh<Policy>(x[i]);
  } else if constexpr (constexpr std::size_t W = detail::row_lanes<T, N>; N < W) {
    T values[W] = {}, results[W];
    for (std::size_t i = 0; i < N; ++i) values[i] = x[i];
    tanh<W>(values, results);
    for (std::size_t i = 0; i < N; ++i) y[i] = results[i];
  } else {
    skinctl::detail::unrolled<detail::row_blocks<T, N>>([&](auto block) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t i = detail::row_start<T, N>(block);
      detail::tanh_kernel(Lane<T, W>::load(x + i)).store(y + i);
    });
  }
}

/// tanh of a row of joints; the results are those of the array.
template <std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE skinctl::detail::Row<N, T> tanh(const skinctl::detail::Row<N, T>& x) noexcept {
  return skinctl::detail::Row<N, T>::made([&](std::size_t k) SKINCTL_INLINE_LAMBDA {
    if constexpr (detail::has_kernel<T>) {
      return detail::tanh_kernel(x.block[k]);
    } else {
      using std::tanh;
      return tanh(x.block[k]);
    }
  });
}

/// `y[i] = tanh x[i]` of an array; `y` may not be `x`.
template <class Policy = Fast, Scalar T, std::size_t N>
SKINCTL_INLINE void tanh(const std::array<T, N>& x, std::array<T, N>& y) noexcept {
  tanh<N, Policy>(x.data(), y.data());
}

}  // namespace math
SKINCTL_END_NAMESPACE
