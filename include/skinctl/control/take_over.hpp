// Bumpless transfer from another law, or from any torque that was applied before.
#pragma once

#include "skinctl/core/evaluate.hpp"
#include "skinctl/trajectory/detail/carrying_law.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A law that begins with the torque that was applied before it:
///
///     tau_out = tau + (1 - a1((t - t0) / T_h)) (tau_out(t0-) - tau(t0+)).
///
/// For bumpless transfers between laws of any kind. (Resets within a tracking law need no such difference:
/// their reference is continuous, see `SurfaceBias`.) The last share is the difference.
template <std::size_t N, class L, Real T = double>
class TakeOver : public detail::CarryingLaw<N, L, T> {
  using Carrying = detail::CarryingLaw<N, L, T>;

 public:
  using typename Carrying::Memory;
  static constexpr bool compensates_friction = detail::compensates_friction<L>;

  /// @param law   the law that takes over.
  /// @param ramp  T_h, 0.1 s by default.
  explicit TakeOver(const L& law, const Ramp<T>& ramp = Ramp<T>()) : Carrying(law, ramp) {}
  /// Throws `ConfigurationError` where the law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    detail::check_law_for(this->law(), robot);
  }

  /// Begins with the law's own torque.
  using Carrying::start;
  /// Begins with `before` [N m], the torque that was applied last. One that is not finite counts as zero.
  template <class K>
  [[nodiscard]] Memory start(const K& known, const JointTorque<N, T>& before) const noexcept {
    return from(this->law().start(known), known, before);
  }
  /// Goes on with another memory of the law and ramps the difference out: for resets that the law does not
  /// smooth.
  template <class K>
  [[nodiscard]] Memory changed(const Memory& memory, const K& known,
                               const typename L::Memory& next) const noexcept {
    return from(next, known, this->torque(memory, known));
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return !this->carries(memory) && skinctl::settled(this->law(), memory.law, known, still);
  }

 private:
  template <class K>
  [[nodiscard]] Memory from(const typename L::Memory& next, const K& known,
                            const JointTorque<N, T>& before) const noexcept {
    Memory memory{next, {}, {}};
    this->carry(memory, before - torque_of(this->law(), next, known));
    return memory;
  }
};

/// `law` for a robot of `N` joints, beginning with a torque that is given to its `start`.
template <std::size_t N, Real T = double, class L>
[[nodiscard]] auto take_over(const L& law, const Ramp<T>& ramp = Ramp<T>()) {
  static_assert(sizeof(detail::Say<detail::fault_in_members<L>(), L>) > 0);
  return TakeOver<N, detail::complete_law<L>, T>(law, ramp);
}

SKINCTL_END_NAMESPACE
