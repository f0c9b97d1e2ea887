// SPDX-License-Identifier: BSD-3-Clause
// Loops whose index is a constant.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Calls `f` with `From` plus each of the numbers, integral constants.
template <std::size_t From = 0, std::size_t... Ix, class F>
SKINCTL_INLINE constexpr void call_with(std::index_sequence<Ix...>, F& f) {
  (f(std::integral_constant<std::size_t, From + Ix>{}), ...);
}

/// Calls `f(0)` to `f(N - 1)`, the index an integral constant. Compilers also unroll a loop of known length,
/// but only after deciding that its arrays stay in memory; GCC vectorises it before, and its vector loads
/// then wait for the scalar stores that filled the array. Where `f` takes a `std::size_t` it is compiled
/// once, not `N` times.
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void unrolled(F&& f) {
  call_with(std::make_index_sequence<N>{}, f);
}

/// As `unrolled` for up to 16 indices, the joints of a hand; a loop beyond, where straight-line code costs
/// too much compile time.
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void for_each_index(F&& f) {
  if constexpr (N <= 16) {
    unrolled<N>(f);
  } else {
    for (std::size_t i = 0; i < N; ++i) f(i);
  }
}

/// As `unrolled` for up to 8 indices, for loops within loops over joints: a limb's joints, where
/// straight-line code keeps every number in a register. (The compilers leave such a loop in a large function,
/// and then its arrays in memory.)
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void for_each_of_few(F&& f) {
  if constexpr (N <= 8) {
    unrolled<N>(f);
  } else {
    for (std::size_t i = 0; i < N; ++i) f(i);
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
