// SPDX-License-Identifier: BSD-3-Clause
// One memory per law of a sum: a plain aggregate, because std::tuple is not trivially copyable.
#pragma once

#include <cstddef>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <class... M>
struct Memories {};
template <class First, class... Rest>
struct Memories<First, Rest...> {
  [[no_unique_address]] First first;
  [[no_unique_address]] Memories<Rest...> rest;
};
/// The memories of laws without any: no aggregate, as Clang 16 crashes on one whose members have no byte.
template <class First, class... Rest>
  requires(std::is_empty_v<First> && (std::is_empty_v<Rest> && ...))
struct Memories<First, Rest...> {
  [[no_unique_address]] First first;
  [[no_unique_address]] Memories<Rest...> rest;
  constexpr Memories() noexcept = default;
  constexpr Memories(const First&, const Memories<Rest...>&) noexcept {}
};

/// The memories of the laws from the `Ix`-th on.
template <std::size_t Ix, class First, class... Rest>
struct Tail : Tail<Ix - 1, Rest...> {};
template <class First, class... Rest>
struct Tail<0, First, Rest...> {
  using type = Memories<First, Rest...>;
};
template <std::size_t Ix, class... M>
using MemoriesFrom = typename Tail<Ix, M...>::type;

/// The `Ix`-th memory.
template <std::size_t Ix, class M>
SKINCTL_INLINE constexpr auto& memory_of(M& memories) noexcept {
  if constexpr (Ix == 0) {
    return memories.first;
  } else {
    return memory_of<Ix - 1>(memories.rest);
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
