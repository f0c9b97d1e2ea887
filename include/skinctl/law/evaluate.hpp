// Evaluation of a law: calls its members where it has them, else derives the result from the required ones.
#pragma once

#include <array>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/law/detail/check_law.hpp"
#include "skinctl/law/law.hpp"

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
template <class L>
struct TermsOf {
  static constexpr std::size_t value = 1;
};
template <class L>
  requires requires { L::terms; }
struct TermsOf<L> {
  static constexpr std::size_t value = L::terms;
};
template <class L, class K, class G>
inline constexpr bool follows_targets =
    requires(const L& law, const typename L::Memory& m, const K& k, const G& g) { law.follow(m, k, g); };
template <class L>
inline constexpr bool reports = requires(const L& law, const typename L::Memory& m) { law.status(m); };
template <class L, class K>
inline constexpr bool says_settled = requires(const L& law, const typename L::Memory& m, const K& k,
                                              const typename K::scalar& still) { law.settled(m, k, still); };

/// Compares a law's settings with the robot's, if the law has `check_for`.
template <class Law, class Terms>
void check_law_for(const Law& law, const Terms& robot) {
  if constexpr (requires { law.check_for(robot); }) law.check_for(robot);
}
template <class L>
inline constexpr bool compensates_friction = requires { requires L::compensates_friction; };

/// Whether no speed exceeds `most`; false if one is NaN.
template <class V, class T>
[[nodiscard]] constexpr bool slower(const V& velocity, const T& most) noexcept {
  for (const T& v : velocity)
    if (!(v <= most && -v <= most)) return false;
  return true;
}

/// `feedback * parts.feedback + feed_forward * parts.feed_forward`, with or without G(q) according to `G`.
template <GravityTerm G, class L, class K>
[[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> weighted_torque(
    const L& law, const typename L::Memory& memory, const K& known,
    const LawShare<typename K::scalar>& share) noexcept {
  if constexpr (has_weighted_torque<L, K>) {
    return law.template torque<G>(memory, known, share);
  } else {
    const auto parts = [&] {
      if constexpr (has_stateless_parts<L, K>) {
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
}  // namespace detail

/// Number of parts whose shares a law reports: its `terms`, or 1.
template <class L>
inline constexpr std::size_t terms_of = detail::TermsOf<L>::value;

namespace detail {
/// The role of the `i`-th part of a law.
template <class L>
constexpr LawRole role_of_part([[maybe_unused]] std::size_t i) noexcept {
  if constexpr (requires { L::roles; }) {
    return L::roles[i];
  } else {
    return L::role;
  }
}
/// The roles of a law's parts, and of a difference that is carried beside them.
template <class L>
inline constexpr auto roles_with_carried = [] {
  std::array<LawRole, terms_of<L> + 1> roles{};
  for (std::size_t i = 0; i < terms_of<L>; ++i) roles[i] = role_of_part<L>(i);
  roles[terms_of<L>] = LawRole::tracking;
  return roles;
}();
}  // namespace detail

/// The torque of `law` [N m] for the interval that begins now, gravity included where it tracks.
template <class L, class K>
[[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque_of(
    const L& law, const typename L::Memory& memory, const K& known) noexcept {
  if constexpr (detail::has_torque<L, K>) {
    return law.torque(memory, known);
  } else if constexpr (detail::has_stateless_torque<L, K>) {
    return law.torque(known);
  } else {
    return detail::weighted_torque<GravityTerm::included>(law, memory, known, {});
  }
}

/// The reasons for what `law` limits, holds or ramps out in this cycle: its `status`, or none.
template <class L>
[[nodiscard]] SKINCTL_INLINE Status status_of(const L& law, const typename L::Memory& memory) noexcept {
  if constexpr (detail::reports<L>) {
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
  if constexpr (detail::says_settled<L, K>) {
    return law.settled(memory, known, still);
  } else {
    return detail::slower(known.dq(), still);
  }
}

/// The torque of `law` for the interval that begins now, and its memory after `dt` seconds. Uses the law's
/// own `evaluate` where it has one, which computes the common terms of torque and memory once.
template <class L, class K>
[[nodiscard]] SKINCTL_INLINE auto evaluate(const L& law, const typename L::Memory& memory, const K& known,
                                           typename K::scalar dt) noexcept {
  using Result = Evaluation<K::joints, typename K::scalar, typename L::Memory, terms_of<L>>;
  if constexpr (requires {
                  { law.evaluate(memory, known, dt) } -> std::same_as<Result>;
                }) {
    return law.evaluate(memory, known, dt);
  } else {
    static_assert(Law<L, K>, "a law has Memory, needs, role, start, torque and advance: see law/law.hpp");
    static_assert(terms_of<L> == 1, "a law of several terms reports their shares by its own evaluate");
    using Torque = JointTorque<K::joints, typename K::scalar>;
    // Written in the blocks in which it is read: see `copy_row`.
    const detail::Row<K::joints, typename K::scalar> torque(torque_of(law, memory, known));
    return Result{Torque(torque),
                  law.advance(memory, known, dt, Opposition::none),
                  {Torque(torque)},
                  status_of(law, memory)};
  }
}

/// The memory of a law after a goal, which may be the next sample of a moving target: by `follow` where the
/// law has one, which distinguishes a sample from a new goal, else by `receive`.
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
