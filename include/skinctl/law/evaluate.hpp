// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of a law: calls its members where it has them, else derives the result from the required ones.
#pragma once

#include "skinctl/law/law_table.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The result of one evaluation. `shares` are the torques of the parts of the law, for the log; they add up
/// to `torque`.
template <std::size_t N, Scalar T, class M, std::size_t Terms>
struct Evaluation {
  JointTorque<N, T> torque;
  M memory;
  std::array<JointTorque<N, T>, Terms> shares;
  Status status;
};

namespace detail {
/// Whether no speed exceeds `most`; false if one is NaN.
template <class V, class T>
[[nodiscard]] constexpr bool slower(const V& velocity, const T& most) noexcept {
  for (const T& v : velocity)
    if (!(v <= most && -v <= most)) return false;
  return true;
}

/// The torque of a tracking law, its parts weighted by `share`, with or without G(q) according to `G` [N m].
template <GravityTerm G, class L, class K>
[[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> weighted_torque(
    const L& law, const typename L::Memory& memory, const K& known,
    const LawShare<typename K::scalar>& share) noexcept {
  if constexpr (HasWeightedTorque<L, K>) {
    return law.template torque<G>(memory, known, share);
  } else {
    const auto parts = [&] {
      if constexpr (HasStatelessParts<L, K>) {
        return law.parts(known);
      } else {
        return law.parts(memory, known);
      }
    }();
    auto tau = share.feedback * parts.feedback + share.feed_forward * parts.feed_forward;
    if constexpr (G == GravityTerm::included) tau += share.feed_forward * known.gravity();
    return tau;
  }
}

/// Stand-in for the terms that torque and next memory share, for a law that has no `now`.
struct Nothing {};
template <class L, class K>
SKINCTL_INLINE auto now_of(const L& law, const typename L::Memory& memory, const K& known) noexcept {
  if constexpr (HasNow<L, K>) {
    return law.now(memory, known);
  } else {
    return Nothing{};
  }
}
/// A tracking law's torque and next memory, with the terms that both share.
template <GravityTerm G, class L, class K, class T, class Now>
SKINCTL_INLINE auto torque_with(const L& law, const typename L::Memory& memory, const K& known,
                                const LawShare<T>& share, const Now& now) noexcept {
  if constexpr (std::same_as<Now, Nothing>) {
    return weighted_torque<G>(law, memory, known, share);
  } else {
    return law.template torque<G>(memory, known, share, now);
  }
}
template <class L, class K, class T, class Now>
SKINCTL_INLINE typename L::Memory advance_with(const L& law, const typename L::Memory& memory, const K& known,
                                               const T& dt, Opposition opposition, const Now& now) noexcept {
  if constexpr (std::same_as<Now, Nothing>) {
    return law.advance(memory, known, dt, opposition);
  } else {
    return law.advance(memory, known, dt, opposition, now);
  }
}
}  // namespace detail

/// The torque of `law` [N m] for the interval that begins now, gravity included where it tracks.
template <class L, class K>
[[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque_of(
    const L& law, const typename L::Memory& memory, const K& known) noexcept {
  if constexpr (detail::HasTorque<L, K>) {
    return law.torque(memory, known);
  } else if constexpr (detail::HasStatelessTorque<L, K>) {
    return law.torque(known);
  } else {
    return detail::weighted_torque<GravityTerm::included>(law, memory, known, {});
  }
}

/// The reasons for what `law` limits, holds or ramps out in this cycle: its `status`, or none.
template <class L>
[[nodiscard]] SKINCTL_INLINE Status status_of(const L& law, const typename L::Memory& memory) noexcept {
  if constexpr (detail::HasStatus<L>) {
    return law.status(memory);
  } else {
    return {};
  }
}

/// Whether `law` has come to rest at its goal: by its own `settled`, else whether no joint is faster than
/// `still` [rad/s].
template <class L, class K>
[[nodiscard]] SKINCTL_NOINLINE bool settled(const L& law, const typename L::Memory& memory, const K& known,
                                            const typename K::scalar& still) noexcept {
  if constexpr (detail::HasSettled<L, K>) {
    return law.settled(memory, known, still);
  } else {
    return detail::slower(known.dq(), still);
  }
}

/// The memory of `law` after a stop or a brake, in which others moved the robot: by its own `resumed`, else
/// unchanged.
template <class L, class K>
[[nodiscard]] SKINCTL_COLD typename L::Memory resumed(const L& law, const typename L::Memory& memory,
                                                      const K& known) noexcept {
  if constexpr (detail::HasResumed<L, K>) {
    return law.resumed(memory, known);
  } else {
    return memory;
  }
}

namespace detail {
/// Evaluates a law of one term by its torque, `advance` and status.
template <class Result, class L, class K>
[[nodiscard]] SKINCTL_INLINE Result evaluate_apart(const L& law, const typename L::Memory& memory,
                                                   const K& known, const typename K::scalar& dt) noexcept {
  const JointTorque<K::joints, typename K::scalar> torque = torque_of(law, memory, known);
  return Result{torque, law.advance(memory, known, dt, Opposition::none), {torque}, status_of(law, memory)};
}
}  // namespace detail

/// The torque of `law` for the interval that begins now, and its memory after `dt` seconds. Uses the law's
/// own `evaluate` where it has one, which computes the common terms of torque and memory once.
template <class L, class K>
[[nodiscard]] SKINCTL_INLINE auto evaluate(const L& law, const typename L::Memory& memory, const K& known,
                                           typename K::scalar dt) noexcept {
  using Result = Evaluation<K::joints, typename K::scalar, typename L::Memory, terms_of<L>>;
  if constexpr (detail::HasEvaluate<L, K, terms_of<L>>) {
    return law.evaluate(memory, known, dt);
  } else {
    static_assert(Law<L, K>, "a law has Memory, needs, role, start, torque and advance: see law/law.hpp");
    static_assert(terms_of<L> == 1, "a law of several terms reports their shares by its own evaluate");
    return detail::evaluate_apart<Result>(law, memory, known, dt);
  }
}

/// The memory of a law after a goal, which may be the next sample of a moving target: by `follow` where the
/// law has one, which distinguishes a sample from a new goal, else by `receive`.
template <class L, class K, class G>
[[nodiscard]] SKINCTL_COLD Received<typename L::Memory> follow_or_receive(const L& law,
                                                                          const typename L::Memory& memory,
                                                                          const K& known,
                                                                          const G& goal) noexcept {
  if constexpr (detail::Follows<L, K, G>) {
    return law.follow(memory, known, goal);
  } else {
    return law.receive(memory, known, goal);
  }
}

SKINCTL_END_NAMESPACE
