// SPDX-License-Identifier: BSD-3-Clause
// A tracking law that drives some joints of a robot and leaves the others alone: an arm's law on an arm with
// a hand.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/law/wrapped_law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The tracking law `L` of a tool on the joints of `Set`: `OnJoints<joints_between(0,
/// 6)>(SplineOperational<22, 5>(...))`. The other joints get their gravity, as from any tracking law, and no
/// other torque of it: neither feedback, nor the damping of a null space. What moves them is another law's.
///
/// The law still knows the whole robot: gravity and inertia of the hand that an arm carries are in its model.
/// A finger that moves against the arm disturbs it: its momentum couples into the arm's feedback. Fingers
/// that another law holds do so little; one that swings freely does not.
///
/// `settled` asks for the joints of `Set` only.
template <LinkMask Set, class L>
class OnJoints : public WrappedLaw<OnJoints<Set, L>, L> {
  using Space = std::remove_cvref_t<decltype(std::declval<const L&>().space())>;
  using T = typename L::T;

 public:
  static constexpr std::size_t N = L::N;
  using Driven = JointSubset<N, Set>;
  static_assert(Driven::count > 0, "a law on no joint");
  static_assert(!Space::of_joints,
                "a joint law tracks every joint that it is made for: OnJoints is for laws that move a tool");
  static constexpr Needs needs = L::needs | Needs{.gravity = true};
  struct Memory : L::Memory {};

  explicit OnJoints(const L& law) : WrappedLaw<OnJoints, L>(law) {}

  template <GravityTerm G, class K, class Now>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> changed(const JointTorque<N, T>& all, const Memory&,
                                                         const K& known, const LawShare<T>& share,
                                                         const Now&) const noexcept {
    JointTorque<N, T> tau;
    if constexpr (G == GravityTerm::included) tau = share.feed_forward * known.gravity();
    Driven::put(Driven::of(all), tau);
    return tau;
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return !this->status(memory).has(Reason::opposed) && Space::stands(this->reference(memory)) &&
           detail::slower(Driven::of(known.dq()), still) &&
           detail::slower(Driven::of(this->now(memory, known).dq_r), still);
  }
};
/// The law on the joints of `Set` only: `on_joints<Set>(law)`.
template <LinkMask Set, class L>
[[nodiscard]] OnJoints<Set, L> on_joints(const L& law) {
  return OnJoints<Set, L>(law);
}

SKINCTL_END_NAMESPACE
