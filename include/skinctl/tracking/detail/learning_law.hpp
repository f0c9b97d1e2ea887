// SPDX-License-Identifier: BSD-3-Clause
// A tracking law beside which a torque is learnt: what `Adaptive` and `FrictionLearning` share.
#pragma once

#include "skinctl/law/wrapped_law.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The tracking law `L` with a learnt torque added. `Self` says what is learnt:
///
/// - `learnt_torque(memory, known, at_t)` is the torque;
/// - `learn(memory, known, dt, opposition, at_t)` changes the `Learnt` of the memory; `opposition` is
///   `lasting` while the skin pushes against the law.
template <class Self, class L, class Learnt>
class LearningLaw : public WrappedLaw<Self, L> {
 public:
  static constexpr std::size_t N = L::N;
  using T = typename L::T;
  using Surface = typename L::Surface;
  struct Memory : L::Memory, Learnt {};

  template <GravityTerm, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> changed(const JointTorque<N, T>& tau, const Memory& memory,
                                                         const K& known, const LawShare<T>& share,
                                                         const Surface& at_t) const noexcept {
    return tau + share.feed_forward * self().learnt_torque(memory, known, at_t);
  }
  template <class K>
  SKINCTL_INLINE void moved_on(Memory& next, const K& known, const T& dt, Opposition opposition,
                               const Surface& at_t) const noexcept {
    self().learn(next, known, dt, opposition, at_t);
  }
  /// See `Tracking::with_target`.
  template <class Target>
  [[nodiscard]] static Memory with_target(Memory memory, const Target& target) noexcept {
    static_cast<typename L::Memory&>(memory) = L::with_target(memory, target);
    return memory;
  }

 protected:
  explicit LearningLaw(const L& law) : WrappedLaw<Self, L>(law) {}

  /// `value` within `+-bound`; `last` where it is not finite.
  [[nodiscard]] static T kept(const T& value, const T& bound, const T& last) noexcept {
    if (!(value - value == T(0))) return last;
    return value > bound ? bound : (value < -bound ? T(-bound) : value);
  }

 private:
  [[nodiscard]] SKINCTL_INLINE const Self& self() const noexcept { return static_cast<const Self&>(*this); }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
