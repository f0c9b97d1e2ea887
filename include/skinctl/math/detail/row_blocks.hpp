// SPDX-License-Identifier: BSD-3-Clause
// Division of a row of N numbers into lanes.
#pragma once

#include <cstddef>
#include <type_traits>

#include "skinctl/core/lane.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

template <class T>
inline constexpr bool has_kernel = std::is_same_v<T, float> || std::is_same_v<T, double>;

/// The lanes of single numbers, and of rows shorter than the register: 16 bytes.
template <class T>
inline constexpr std::size_t narrow_lanes = native_lanes<T> == 1 ? 1 : 16 / sizeof(T);

/// The number of lanes that fits both the register and the row.
template <class T, std::size_t N>
inline constexpr std::size_t row_lanes = N >= native_lanes<T> ? native_lanes<T> : narrow_lanes<T>;

/// The number of lanes that covers the row, and the start of lane `block`. The last lane overlaps the
/// one before, so that none is partly filled: six numbers in lanes of four are 0..3 and 2..5.
template <class T, std::size_t N>
inline constexpr std::size_t row_blocks = (N + row_lanes<T, N> - 1) / row_lanes<T, N>;
template <class T, std::size_t N>
[[nodiscard]] constexpr std::size_t row_start(std::size_t block) noexcept {
  constexpr std::size_t W = row_lanes<T, N>;
  static_assert(N >= W);
  return (block + 1) * W <= N ? block * W : N - W;
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
