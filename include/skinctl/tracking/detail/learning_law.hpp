// A tracking law beside which a torque is learnt: what `Adaptive` and `FrictionLearning` share.
#pragma once

#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The tracking law `L` with a learnt torque added. `Self` says what is learnt:
///
/// - `learnt_torque(memory, known, at_t)` is the torque;
/// - `learn(memory, known, dt, opposition, at_t)` changes the `Learnt` of the memory; `opposition` is `lasting` while the
///   skin pushes against the law.
///
/// Everything else is L's, a streamed target too.
template <class Self, class L, class Learnt>
class LearningLaw : public Composable {
 public:
  static constexpr std::size_t N = L::N;
  static constexpr std::size_t joints = N;
  using scalar = typename L::scalar;
  using T = typename L::T;
  using Goal = typename L::Goal;
  using Surface = typename L::Surface;
  static constexpr Needs needs = L::needs;
  static constexpr LawRole role = L::role;
  struct Memory : Learnt {
    typename L::Memory law;
  };

  [[nodiscard]] const L& law() const noexcept { return law_; }
  /// Throws `ConfigurationError` where the law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    check_law_for(law_, robot);
  }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {Learnt{}, law_.start(known)};
  }
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    return with(memory, law_.receive(memory.law, known, goal));
  }
  template <class K>
  [[nodiscard]] Received<Memory> follow(const Memory& memory, const K& known, const Goal& goal) const noexcept
    requires requires(const L& law) { law.follow(memory.law, known, goal); }
  {
    return with(memory, law_.follow(memory.law, known, goal));
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Surface now(const Memory& memory, const K& known) const noexcept {
    return law_.now(memory.law, known);
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<N, T> torque(const Memory& memory, const K& known, const LawShare<T>& share,
                                         const Surface& at_t) const noexcept {
    return law_.template torque<G>(memory.law, known, share, at_t) +
           share.feed_forward * self().learnt_torque(memory, known, at_t);
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<N, T> torque(const Memory& memory, const K& known,
                                         const LawShare<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, now(memory, known));
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt, Opposition opposition,
                               const Surface& at_t) const noexcept {
    Memory next = memory;
    next.law = law_.advance(memory.law, known, dt, opposition, at_t);
    self().learn(next, known, dt, opposition, at_t);
    return next;
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt,
                               Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, now(memory, known));
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return law_.settled(memory.law, known, still);
  }
  template <class K, class G>
  [[nodiscard]] auto distance(const K& known, const G& goal) const noexcept
    requires requires(const L& law) { law.distance(known, goal); }
  {
    return law_.distance(known, goal);
  }
  /// See `Tracking::with_target`.
  template <class Target>
  [[nodiscard]] static Memory with_target(Memory memory, const Target& target) noexcept {
    memory.law = L::with_target(memory.law, target);
    return memory;
  }
  [[nodiscard]] Status status(const Memory& memory) const noexcept { return law_.status(memory.law); }

 protected:
  explicit LearningLaw(const L& law) : law_(law) {}

  /// `value` within `+-bound`; `last` where it is not finite.
  [[nodiscard]] static T kept(const T& value, const T& bound, const T& last) noexcept {
    if (!(value - value == T(0))) return last;
    return value > bound ? bound : (value < -bound ? T(-bound) : value);
  }

 private:
  [[nodiscard]] SKINCTL_INLINE const Self& self() const noexcept { return static_cast<const Self&>(*this); }
  template <class Answer>
  [[nodiscard]] static Received<Memory> with(Memory memory, const Answer& answer) noexcept {
    memory.law = answer.memory;
    return {memory, answer.status};
  }

  L law_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
