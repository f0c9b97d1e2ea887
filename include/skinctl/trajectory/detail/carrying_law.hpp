// SPDX-License-Identifier: BSD-3-Clause
// A law with a difference of torque that is ramped out: what was applied before it, by a law or a
// configuration.
#pragma once

#include <tuple>

#include "skinctl/law/wrapped_law.hpp"
#include "skinctl/trajectory/ramp.hpp"

// A parameter may have the name of a member of the law that is wrapped.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A law with a difference of torque that is ramped out:
/// `tau_out = tau + (1 - a1((t - t0) / T_h)) difference`, a1 the quintic. The last share is the difference.
template <std::size_t N, class L, Real T>
class CarryingLaw : public WrappedLaw<CarryingLaw<N, L, T>, L> {
  using Wrapped = WrappedLaw<CarryingLaw, L>;

 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  using Laws = std::tuple<>;  ///< checked already
  struct Memory : L::Memory {
    JointTorque<N, T> difference;
    Nanoseconds elapsed = clock_end;
  };
  static constexpr std::size_t terms = terms_of<L> + 1;
  static constexpr auto roles = LawTable<L>::roles_with_carried;

  CarryingLaw(const L& law, const skinctl::Ramp<T>& ramp) : Wrapped(law), ramp_(ramp) {}

  /// Drops the difference: nothing is added any more.
  static void drop(Memory& memory) noexcept { memory.elapsed = clock_end; }
  /// Begins to ramp `difference` out. A value that is not finite counts as zero.
  static void carry(Memory& memory, const JointTorque<N, T>& difference) noexcept {
    memory.elapsed = Nanoseconds{};
    for (std::size_t i = 0; i < N; ++i)
      memory.difference[i] = difference[i] - difference[i] == T(0) ? difference[i] : T(0);
  }

  template <GravityTerm, class... X>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> changed(const JointTorque<N, T>& tau, const Memory& memory,
                                                         const X&...) const noexcept {
    return tau + rest(memory);
  }
  template <class K, class... X>
  SKINCTL_INLINE void moved_on(Memory& next, const K&, const T& dt, const X&...) const noexcept {
    next.elapsed = later(next.elapsed, nanoseconds(static_cast<double>(dt)));
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<N, T, Memory, terms> evaluate(const Memory& memory, const K& known,
                                                                        const T& dt) const noexcept {
    const auto own = skinctl::evaluate(this->wrapped(), memory, known, dt);
    const auto carried = rest(memory);
    Evaluation<N, T, Memory, terms> out{own.torque + carried, memory, {}, own.status};
    Wrapped::of(out.memory) = own.memory;
    moved_on(out.memory, known, dt);
    for (std::size_t i = 0; i + 1 < terms; ++i) out.shares[i] = own.shares[i];
    out.shares[terms - 1] = carried;
    if (ramp_.lasts(memory.elapsed)) out.status |= Reason::bumpless_transfer;
    return out;
  }

 private:
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> rest(const Memory& memory) const noexcept {
    if (!ramp_.lasts(memory.elapsed)) [[likely]]
      return {};
    return ramp_.down(memory.elapsed) * memory.difference;
  }

  skinctl::Ramp<T> ramp_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
#pragma GCC diagnostic pop
