// A loop over the rows of a small matrix, written out by the compiler.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// Up to here straight-line code pays; beyond, it costs the compiler more than it gives.
inline constexpr std::size_t longest_straight_line = 16;

/// `f(0)` to `f(N - 1)`; each index a constant while `N` is small.
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void for_each_index(F&& f) noexcept {
  if constexpr (N <= longest_straight_line) {
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      (f(std::integral_constant<std::size_t, K>{}), ...);
    }(std::make_index_sequence<N>{});
  } else {
    for (std::size_t k = 0; k < N; ++k) f(k);
  }
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
