// SPDX-License-Identifier: BSD-3-Clause
// The laws of a sum, and their goals.
#pragma once

#include <tuple>

#include "skinctl/law/detail/check_law.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// A type that was meant as a law, even if members are missing.
template <class L>
concept MeantAsLaw = LawMembers<L> || std::derived_from<L, Composable>;

/// The one goal type of a sum, if it has exactly one law with goals.
template <class... G>
struct OneGoal {};
template <class G>
struct OneGoal<G> {
  using Goal = G;
};
template <class Found, class... L>
struct GoalOf;
template <class... G>
struct GoalOf<std::tuple<G...>> : OneGoal<G...> {};
template <class... G, class L, class... Rest>
struct GoalOf<std::tuple<G...>, L, Rest...> : GoalOf<std::tuple<G...>, Rest...> {};
template <class... G, HasGoal L, class... Rest>
struct GoalOf<std::tuple<G...>, L, Rest...> : GoalOf<std::tuple<G..., typename L::Goal>, Rest...> {};

/// Calls `f(index)`, the index a type, for each law of a sum.
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void each_index(F&& f) noexcept {
  [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
    (f(std::integral_constant<std::size_t, Ix>{}), ...);
  }(std::make_index_sequence<N>{});
}

template <class... L>
constexpr std::size_t count_role(LawRole role) noexcept {
  return (std::size_t(0) + ... + (L::role == role ? 1u : 0u));
}
}  // namespace detail

SKINCTL_END_NAMESPACE
