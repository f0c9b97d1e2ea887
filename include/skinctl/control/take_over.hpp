// Bumpless transfer from another law, or from any torque that was applied before.
#pragma once

#include <tuple>

#include "skinctl/core/evaluate.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A law that begins with the torque that was applied before it:
///
///     tau_out = tau + (1 - a1((t - t0) / T_h)) (tau_out(t0-) - tau(t0+)).
///
/// For bumpless transfers between laws of any kind. (Resets within a tracking law need no such difference:
/// their reference is continuous, see `SurfaceBias`.) The last share is the difference.
template <std::size_t N, class L, Real T = double>
class TakeOver : public detail::GoalOfLaw<L> {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  using Laws = std::tuple<>;  ///< `take_over` checks the law
  struct Memory {
    typename L::Memory law;
    JointTorque<N, T> difference;
    Nanoseconds elapsed;
  };
  static constexpr Needs needs = L::needs;
  static constexpr LawRole role = L::role;
  static constexpr bool compensates_friction = detail::compensates_friction<L>;
  static constexpr std::size_t terms = terms_of<L> + 1;
  static constexpr auto roles = detail::roles_with_carried<L>;

  /// @param law   the law that takes over.
  /// @param ramp  T_h, 0.1 s by default.
  explicit TakeOver(const L& law, const Ramp<T>& ramp = Ramp<T>()) : law_(law), ramp_(ramp) {}
  [[nodiscard]] const L& law() const noexcept { return law_; }
  /// Throws `ConfigurationError` where the law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    detail::check_law_for(law_, robot);
  }

  /// Begins with the law's own torque.
  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {law_.start(known), {}, clock_end};
  }
  /// Begins with `before` [N m], the torque that was applied last. One that is not finite counts as zero.
  template <class K>
  [[nodiscard]] Memory start(const K& known, const JointTorque<N, T>& before) const noexcept {
    return from(law_.start(known), known, before);
  }
  /// Goes on with another memory of the law and ramps the difference out: for resets that the law does not
  /// smooth.
  template <class K>
  [[nodiscard]] Memory changed(const Memory& memory, const K& known,
                               const typename L::Memory& next) const noexcept {
    return from(next, known, torque(memory, known));
  }
  template <class K, class Goal>
    requires requires { typename L::Goal; }
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    const auto answer = follow_or_receive(law_, memory.law, known, goal);
    return {{answer.memory, memory.difference, memory.elapsed}, answer.status};
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known) const noexcept {
    return torque_of(law_, memory.law, known) + rest(memory);
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return !ramp_.lasts(memory.elapsed) && skinctl::settled(law_, memory.law, known, still);
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition) const noexcept {
    return {law_.advance(memory.law, known, dt, opposition), memory.difference, after(memory, dt)};
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<N, T, Memory, terms> evaluate(const Memory& memory, const K& known,
                                                                        const T& dt) const noexcept {
    const auto own = skinctl::evaluate(law_, memory.law, known, dt);
    const auto carried = rest(memory);
    Evaluation<N, T, Memory, terms> out{
        own.torque + carried, {own.memory, memory.difference, after(memory, dt)}, {}, own.status};
    for (std::size_t i = 0; i + 1 < terms; ++i) out.shares[i] = own.shares[i];
    out.shares[terms - 1] = carried;
    if (ramp_.lasts(memory.elapsed)) out.status |= Reason::bumpless_transfer;
    return out;
  }

 private:
  template <class K>
  [[nodiscard]] Memory from(const typename L::Memory& next, const K& known,
                            const JointTorque<N, T>& before) const noexcept {
    Memory memory{next, before - torque_of(law_, next, known), Nanoseconds{}};
    for (T& x : memory.difference)
      if (!(x - x == T(0))) x = T(0);
    return memory;
  }
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> rest(const Memory& memory) const noexcept {
    if (!ramp_.lasts(memory.elapsed)) [[likely]]
      return {};
    return ramp_.down(memory.elapsed) * memory.difference;
  }
  [[nodiscard]] static SKINCTL_INLINE Nanoseconds after(const Memory& memory, const T& dt) noexcept {
    return later(memory.elapsed, nanoseconds(static_cast<double>(dt)));
  }

  L law_;
  Ramp<T> ramp_;
};

/// `law` for a robot of `N` joints, beginning with a torque that is given to its `start`.
template <std::size_t N, Real T = double, class L>
[[nodiscard]] auto take_over(const L& law, const Ramp<T>& ramp = Ramp<T>()) {
  static_assert(sizeof(detail::Say<detail::fault_in_members<L>(), L>) > 0);
  return TakeOver<N, detail::complete_law<L>, T>(law, ramp);
}

SKINCTL_END_NAMESPACE
