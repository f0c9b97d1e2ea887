// SPDX-License-Identifier: BSD-3-Clause
// Laws as an expression: `0.6 * skin + 0.4 * reach + gravity`.
#pragma once

#include "skinctl/fusion/fused.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
template <class L>
inline constexpr bool is_fused = false;
template <Sum P, class... L>
inline constexpr bool is_fused<Fused<P, L...>> = true;
template <Sum P, class... L>
inline constexpr bool lives_on_skin<Fused<P, L...>> = (lives_on_skin<L> || ...);

/// A law as a sum of one; a sum as it is.
template <class L>
auto as_sum(const L& law) {
  if constexpr (is_fused<L>) {
    return law;
  } else {
    using Law = law_in_sum<L>;
    return Fused<Sum::normalised, Law>(std::tuple<Law>(law), {1.0});
  }
}
template <Sum To, Sum From, class... L>
auto with_policy(const Fused<From, L...>& sum) {
  return Fused<To, L...>(sum.laws(), sum.weights(), sum.detector());
}
template <Sum P, Sum Q, class... A, class... B>
auto join(const Fused<P, A...>& a, const Fused<Q, B...>& b) {
  std::array<double, sizeof...(A) + sizeof...(B)> weights{};
  for (std::size_t i = 0; i < sizeof...(A); ++i) weights[i] = a.weights()[i];
  for (std::size_t i = 0; i < sizeof...(B); ++i) weights[sizeof...(A) + i] = b.weights()[i];
  return Fused<Sum::normalised, A..., B...>(std::tuple_cat(a.laws(), b.laws()), weights);
}
/// Whether `A` is, or has, a law of the skin without settings that `B` has too.
template <class A, class B>
constexpr bool repeats_touch() noexcept {
  if constexpr (!MeantAsLaw<A> || !MeantAsLaw<B>) {
    return false;
  } else if constexpr (is_fused<A>) {
    return []<Sum P, class... L>(const Fused<P, L...>*) {
      return (repeats_touch<L, B>() || ...);
    }(static_cast<const A*>(nullptr));
  } else if constexpr (is_fused<B>) {
    return repeats_touch<B, A>();
  } else {
    return std::is_same_v<A, B> && std::is_empty_v<A> && LawTable<A>::answers_touch;
  }
}
template <class W, class L>
constexpr bool weighs() noexcept {
  if constexpr (std::is_arithmetic_v<W> && MeantAsLaw<L>) {
    return LawTable<L>::gravity_laws == 0 && !LawTable<L>::is_complete_sum;
  } else {
    return false;
  }
}
template <class A, class B>
constexpr bool adds() noexcept {
  if constexpr (MeantAsLaw<A> && MeantAsLaw<B>) {
    return !LawTable<A>::is_complete_sum && !LawTable<B>::is_complete_sum;
  } else {
    return false;
  }
}
template <class A, class B>
constexpr bool holds_twice() noexcept {
  if constexpr (adds<A, B>()) {
    return LawTable<A>::gravity_laws + LawTable<B>::gravity_laws > 1 || repeats_touch<A, B>();
  } else {
    return false;
  }
}
/// Stand-in for a sum that has been refused with an error: the one of both that is a law.
template <class A, class B>
auto either_law(const A& a, const B& b) {
  if constexpr (MeantAsLaw<A>) {
    return a;
  } else {
    return b;
  }
}
}  // namespace detail

namespace expression {

// One operator each, whose assertions name the fault: beside a deleted one, compilers list all candidates.

/// A law with a weight, > 0, on either side. Throws `ConfigurationError` for other weights.
template <class A, class B>
[[nodiscard]] auto operator*(const A& a, const B& b) {
  constexpr bool weighs = detail::weighs<A, B>() || detail::weighs<B, A>();
  static_assert(weighs, "gravity keeps weight 1, and only numbers are weights");
  if constexpr (!weighs) {
    return detail::either_law(a, b);
  } else if constexpr (std::is_arithmetic_v<A>) {
    static_assert(sizeof(detail::Say<detail::fault_in_sum<B>(), B>) > 0);
    auto sum = detail::as_sum(b);
    auto weights = sum.weights();
    for (double& w : weights) w *= static_cast<double>(a);
    return decltype(sum)(sum.laws(), weights, sum.detector());
  } else {
    return b * a;
  }
}

/// The sum of two laws or sums, with the default policy and thresholds; `plain`, `weighted` and `opposed_by`
/// apply to the whole sum.
template <class A, class B>
[[nodiscard]] auto operator+(const A& a, const B& b) {
  constexpr bool adds = detail::adds<A, B>(), twice = detail::holds_twice<A, B>();
  static_assert(adds,
                "a law adds to laws only: a torque comes from law.torque(memory, known), "
                "a blend of the whole sum");
  static_assert(!twice, "gravity twice: keep one gravity law; a law of the skin twice: keep one");
  if constexpr (adds && !twice) {
    static_assert(sizeof(detail::Say<detail::fault_in_sum<A>(), A>) > 0);
    static_assert(sizeof(detail::Say<detail::fault_in_sum<B>(), B>) > 0);
    static_assert(!detail::are_for_two_robots<A, B>,
                  "the laws of a sum are for robots with different numbers of joints");
    return detail::join(detail::as_sum(a), detail::as_sum(b));
  } else {
    return detail::either_law(a, b);
  }
}

}  // namespace expression

/// `sum` with the policy `Sum::weighted`: feedback with the weights as given, feed-forward with the
/// normalised ones.
template <Sum P, class... L>
[[nodiscard]] Fused<Sum::weighted, L...> weighted(const Fused<P, L...>& sum) {
  return detail::with_policy<Sum::weighted>(sum);
}
/// `sum` with the policy `Sum::plain`, as the paper writes it.
template <Sum P, class... L>
[[nodiscard]] Fused<Sum::plain, L...> plain(const Fused<P, L...>& sum) {
  return detail::with_policy<Sum::plain>(sum);
}

SKINCTL_END_NAMESPACE
