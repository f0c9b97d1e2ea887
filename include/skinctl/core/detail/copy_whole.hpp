// SPDX-License-Identifier: BSD-3-Clause
// Copies of some hundred bytes in the loop.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `to = from`, register by register. GCC copies more than a hundred bytes or so with an instruction (`rep
/// movs`) that starts slowly, and behind which loads of the copy wait.
template <class V>
SKINCTL_INLINE void copy_whole(const V& from, V& to) noexcept {
#if defined(__SSE2__)
  constexpr std::size_t wide = 32, pieces = sizeof(V) / wide, rest = sizeof(V) % wide;
  if constexpr (std::is_trivially_copyable_v<V> && pieces > 2 && pieces <= 64) {
    typedef float Piece __attribute__((vector_size(wide), aligned(1), may_alias));
    const auto* const source = reinterpret_cast<const std::byte*>(&from);
    auto* const target = reinterpret_cast<std::byte*>(&to);
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
      ((*reinterpret_cast<Piece*>(target + wide * Ix) = *reinterpret_cast<const Piece*>(source + wide * Ix)),
       ...);
    }(std::make_index_sequence<pieces>{});
    if constexpr (rest > 0) std::memcpy(target + wide * pieces, source + wide * pieces, rest);
    return;
  }
#endif
  to = from;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
