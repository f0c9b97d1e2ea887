// A law with a difference of torque that is ramped out: what was applied before it, by a law or a configuration.
#pragma once

#include <tuple>

#include "skinctl/law/evaluate.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `tau_out = tau + (1 - a1((t - t0) / T_h)) difference`. The last share is the difference.
template <std::size_t N, class L, Real T>
class CarryingLaw : public GoalOfLaw<L> {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  using Laws = std::tuple<>;  ///< checked already
  struct Memory {
    typename L::Memory law;
    JointTorque<N, T> difference;
    Nanoseconds elapsed;
  };
  static constexpr Needs needs = L::needs;
  static constexpr LawRole role = L::role;
  static constexpr std::size_t terms = terms_of<L> + 1;
  static constexpr auto roles = roles_with_carried<L>;

  CarryingLaw(const L& law, const skinctl::Ramp<T>& ramp) : law_(law), ramp_(ramp) {}
  [[nodiscard]] const L& law() const noexcept { return law_; }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {law_.start(known), {}, clock_end};
  }
  template <class K, class Goal>
    requires requires { typename L::Goal; }
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    const auto answer = follow_or_receive(law_, memory.law, known, goal);
    return {{answer.memory, memory.difference, memory.elapsed}, answer.status};
  }
  /// No difference.
  static void drop(Memory& memory) noexcept { memory.elapsed = clock_end; }
  /// Begins to ramp `difference` out. A value that is not finite counts as zero.
  static void carry(Memory& memory, const JointTorque<N, T>& difference) noexcept {
    memory.elapsed = Nanoseconds{};
    for (std::size_t i = 0; i < N; ++i)
      memory.difference[i] = difference[i] - difference[i] == T(0) ? difference[i] : T(0);
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known) const noexcept {
    return torque_of(law_, memory.law, known) + rest(memory);
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
    if (carries(memory)) out.status |= Reason::bumpless_transfer;
    return out;
  }

 protected:
  [[nodiscard]] bool carries(const Memory& memory) const noexcept { return ramp_.lasts(memory.elapsed); }

 private:
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> rest(const Memory& memory) const noexcept {
    if (!carries(memory)) [[likely]]
      return {};
    return ramp_.down(memory.elapsed) * memory.difference;
  }
  [[nodiscard]] static SKINCTL_INLINE Nanoseconds after(const Memory& memory, const T& dt) noexcept {
    return later(memory.elapsed, nanoseconds(static_cast<double>(dt)));
  }

  L law_;
  skinctl::Ramp<T> ramp_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
