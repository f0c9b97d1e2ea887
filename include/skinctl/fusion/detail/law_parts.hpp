// The members that a sum uses of its laws, their goals, and the quantities that torque and memory share.
#pragma once

#include <tuple>

#include "skinctl/law/evaluate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Any type with the members of a law, whatever the robot. It names members, not a call: an Eigen vector is
/// callable too.
template <class L>
concept LawMembers = requires {
  typename L::Memory;
  { L::needs } -> std::convertible_to<Needs>;
  { L::role } -> std::convertible_to<LawRole>;
};

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
template <class... G, class L, class... Rest>
  requires requires { typename L::Goal; }
struct GoalOf<std::tuple<G...>, L, Rest...> : GoalOf<std::tuple<G..., typename L::Goal>, Rest...> {};

/// The quantities that a law's torque and memory share, if it has none.
struct Nothing {};
template <class Law, class K>
SKINCTL_INLINE auto now_of(const Law& law, const typename Law::Memory& memory, const K& known) noexcept {
  if constexpr (requires { law.now(memory, known); }) {
    return law.now(memory, known);
  } else {
    return Nothing{};
  }
}
/// A tracking law's torque and next memory, with the quantities that both share.
template <GravityTerm G, class Law, class K, class T, class Now>
SKINCTL_INLINE auto torque_with(const Law& law, const typename Law::Memory& memory, const K& known,
                                const LawShare<T>& share, const Now& now) noexcept {
  if constexpr (std::same_as<Now, Nothing>) {
    return weighted_torque<G>(law, memory, known, share);
  } else {
    return law.template torque<G>(memory, known, share, now);
  }
}
template <class Law, class K, class T, class Now>
SKINCTL_INLINE typename Law::Memory advance_with(const Law& law, const typename Law::Memory& memory,
                                                 const K& known, const T& dt, Opposition opposition,
                                                 const Now& now) noexcept {
  if constexpr (std::same_as<Now, Nothing>) {
    return law.advance(memory, known, dt, opposition);
  } else {
    return law.advance(memory, known, dt, opposition, now);
  }
}
/// Whether a law waits behind a gate (fusion/blended.hpp).
template <class L>
inline constexpr bool is_gated = requires { L::gate; };

/// Whether a tracking law presses against an obstacle on purpose: the skin does not oppose it.
template <class L>
inline constexpr bool presses = requires { L::presses; };

/// Whether a law is the skin's response: others may oppose it, and it opens gates. A reactive law that does
/// not read touch (a joint limit, a posture) opposes nothing.
template <class L>
inline constexpr bool answers_touch = L::role == LawRole::reactive && Needs(L::needs).touch;

// Traits, not requires-expressions in generic lambdas: Clang 14 takes those for false.
template <class L>
inline constexpr bool takes_goals = requires { typename L::Goal; };
/// Whether the sum of a tracking law's parts contains G(q) where no gravity law is loaded.
template <class L>
inline constexpr bool is_in_parts = L::role == LawRole::tracking && !LacksParts<L>;

/// Calls `f(index)`, the index a type, for each law of a sum.
template <std::size_t N, class F>
SKINCTL_INLINE constexpr void each_index(F&& f) noexcept {
  [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
    (f(std::integral_constant<std::size_t, I>{}), ...);
  }(std::make_index_sequence<N>{});
}

template <class... L>
constexpr std::size_t count_role(LawRole role) noexcept {
  return (std::size_t(0) + ... + (L::role == role ? 1u : 0u));
}
}  // namespace detail

SKINCTL_END_NAMESPACE
