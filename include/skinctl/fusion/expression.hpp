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
    using Law = complete_law<L>;
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
constexpr bool adds(std::size_t least, std::size_t most) noexcept {
  if constexpr (MeantAsLaw<A> && MeantAsLaw<B>) {
    const auto count = LawTable<A>::gravity_laws + LawTable<B>::gravity_laws;
    if (repeats_touch<A, B>()) return false;
    return count >= least && count <= most && !LawTable<A>::is_complete_sum && !LawTable<B>::is_complete_sum;
  } else {
    return false;
  }
}
template <class A, class B>
constexpr bool holds_twice() noexcept {
  return adds<A, B>(2, 99) || repeats_touch<A, B>();
}
}  // namespace detail

namespace expression {

/// A law with a weight, > 0, on either side. Throws `ConfigurationError` for other weights.
template <class A, class B>
  requires(detail::weighs<A, B>() || detail::weighs<B, A>())
[[nodiscard]] auto operator*(const A& a, const B& b) {
  if constexpr (std::is_arithmetic_v<A>) {
    static_assert(sizeof(detail::Say<detail::fault_in_members<B>(), B>) > 0);
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
  requires(detail::adds<A, B>(0, 1))
[[nodiscard]] auto operator+(const A& a, const B& b) {
  static_assert(sizeof(detail::Say<detail::fault_in_members<A>(), A>) > 0);
  static_assert(sizeof(detail::Say<detail::fault_in_members<B>(), B>) > 0);
  static_assert(!detail::are_for_two_robots<A, B>,
                "the laws of a sum are for robots with different numbers of joints");
  return detail::join(detail::as_sum(a), detail::as_sum(b));
}

// Operations without meaning.
// clang-format off
template <class A, class B>
void operator*(const A&, const B&) = delete;  // gravity keeps weight 1, and only numbers are weights
template <class A, class B>
  requires(detail::holds_twice<A, B>())
void operator+(const A&, const B&) = delete;  // gravity twice: keep one gravity law; a law of the skin twice: keep one
template <class A, class B>
void operator+(const A&, const B&) = delete;  // a law adds to laws only: a torque comes from law.torque(memory, known), a blend of the whole sum
// clang-format on

}  // namespace expression

/// The same sum with `Sum::weighted`: feedback with the weights as given, feed-forward with the normalised
/// ones.
template <Sum P, class... L>
[[nodiscard]] Fused<Sum::weighted, L...> weighted(const Fused<P, L...>& sum) {
  return detail::with_policy<Sum::weighted>(sum);
}
/// The same sum with `Sum::plain`, as the paper writes it.
template <Sum P, class... L>
[[nodiscard]] Fused<Sum::plain, L...> plain(const Fused<P, L...>& sum) {
  return detail::with_policy<Sum::plain>(sum);
}

SKINCTL_END_NAMESPACE
