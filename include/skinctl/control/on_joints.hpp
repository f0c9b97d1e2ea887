// A tracking law that drives some joints of a robot and leaves the others alone: an arm's law on an arm with a hand.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/tracking/detail/learning_law.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
struct NothingLearnt {};
}  // namespace detail

/// The tracking law `L` of a tool on the joints of `Set`: `OnJoints<joints_between(0, 6)>(SplineOperational<22, 5>(...))`. The other
/// joints get their gravity, as from any tracking law, and no other torque of it: neither feedback, nor the damping of
/// a null space. What moves them is another law's.
///
/// The law still knows the whole robot: gravity and inertia of the hand that an arm carries are in its model. A finger
/// that moves against the arm disturbs it: its momentum couples into the arm's feedback. Fingers that another law holds
/// do so little; one that swings freely does not.
///
/// `settled` asks for the joints of `Set` only.
template <LinkMask Set, class L>
class OnJoints : public detail::LearningLaw<OnJoints<Set, L>, L, detail::NothingLearnt> {
  using Base = detail::LearningLaw<OnJoints<Set, L>, L, detail::NothingLearnt>;

 public:
  using typename Base::Memory;
  using typename Base::Surface;
  using typename Base::T;
  static constexpr std::size_t N = Base::N;
  using Driven = JointSubset<N, Set>;
  static_assert(Driven::count > 0, "a law on no joint");
  static_assert(
      !requires(typename L::Goal goal) { goal.q_g; } && !requires(typename L::Goal goal) { goal.q_d; },
      "a joint law tracks every joint that it is made for: OnJoints is for laws that move a tool");
  static constexpr Needs needs = L::needs | Needs{.gravity = true};
  static constexpr const char* name = L::name;

  explicit OnJoints(const L& law) : Base(law) {}

  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share,
                                                        const Surface& at_t) const noexcept {
    const auto all = this->law().template torque<G>(memory.law, known, share, at_t);
    JointTorque<N, T> tau;
    if constexpr (G == GravityTerm::included) tau = share.feed_forward * known.gravity();
    Driven::put(Driven::of(all), tau);
    return tau;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, this->now(memory, known));
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    using Space = std::remove_cvref_t<decltype(this->law().space())>;
    return !this->law().status(memory.law).has(Reason::opposed) &&
           Space::stands(this->law().reference(memory.law)) &&
           detail::slower(Driven::of(known.dq()), still) &&
           detail::slower(Driven::of(this->now(memory, known).dq_r), still);
  }

 private:
  friend Base;
  template <class... Anything>
  static void learn(Memory&, const Anything&...) noexcept {}
};
/// `on_joints<Set>(law)`.
template <LinkMask Set, class L>
[[nodiscard]] OnJoints<Set, L> on_joints(const L& law) {
  return OnJoints<Set, L>(law);
}

SKINCTL_END_NAMESPACE
