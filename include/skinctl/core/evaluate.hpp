// One evaluation of a law: its torque, its memory after the interval, each part's share, and what happened.
#pragma once

#include <array>

#include "skinctl/core/law.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What one evaluation gives. `shares` are the torques that the parts of the law contribute, for the log;
/// they add up to `torque`.
template <std::size_t N, Scalar T, class M, std::size_t Terms>
struct Evaluation {
  JointTorque<N, T> torque;
  M memory;
  std::array<JointTorque<N, T>, Terms> shares;
  Status status;
};

/// A memory after something was asked for (a new goal), and what came of it.
template <class M>
struct Received {
  M memory;
  Status status;
};

namespace detail {
template <class L>
struct TermsOf {
  static constexpr std::size_t value = 1;
};
template <class L>
  requires requires { L::terms; }
struct TermsOf<L> {
  static constexpr std::size_t value = L::terms;
};
// A trait, not a requires-expression in a generic lambda: Clang 14 takes those for false.
template <class L, class K, class G>
inline constexpr bool follows_targets =
    requires(const L& law, const typename L::Memory& m, const K& k, const G& g) { law.follow(m, k, g); };
}  // namespace detail

/// Number of parts whose shares a law reports: its `terms`, or 1.
template <class L>
inline constexpr std::size_t terms_of = detail::TermsOf<L>::value;

/// The torque of `law` for the interval that begins now, and its memory after `dt` seconds. Uses the law's
/// own `evaluate` where it has one, so that what torque and memory share is computed once.
template <class L, class K>
[[nodiscard]] SKINCTL_INLINE auto evaluate(const L& law, const typename L::Memory& memory, const K& known,
                                           typename K::scalar dt) noexcept {
  using Result = Evaluation<K::joints, typename K::scalar, typename L::Memory, terms_of<L>>;
  if constexpr (requires {
                  { law.evaluate(memory, known, dt) } -> std::same_as<Result>;
                }) {
    return law.evaluate(memory, known, dt);
  } else {
    static_assert(Law<L, K>, "a law has Memory, needs, role, start, torque and advance: see core/law.hpp");
    static_assert(terms_of<L> == 1, "a law of several terms reports their shares by its own evaluate");
    const auto torque = law.torque(memory, known);
    return Result{torque, law.advance(memory, known, dt, Opposition::none), {torque}, Status{}};
  }
}

/// What a law makes of a goal that may also be the next sample of a target that moves: `follow` where it has
/// one, which tells the one from the other, else `receive`.
template <class L, class K, class G>
[[nodiscard]] SKINCTL_COLD Received<typename L::Memory> follow_or_receive(const L& law,
                                                                          const typename L::Memory& memory,
                                                                          const K& known,
                                                                          const G& goal) noexcept {
  if constexpr (detail::follows_targets<L, K, G>) {
    return law.follow(memory, known, goal);
  } else {
    return law.receive(memory, known, goal);
  }
}

SKINCTL_END_NAMESPACE
