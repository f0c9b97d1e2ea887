// SPDX-License-Identifier: BSD-3-Clause
// A law that is made of another one and changes its torque or its memory.
#pragma once

#include "skinctl/law/evaluate.hpp"

// A parameter may have the name of a member of the law that is wrapped.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
SKINCTL_BEGIN_NAMESPACE

namespace detail {
struct NamesOfAWrapper {
  int changed, moved_on;
};
SKINCTL_NAMES(ChangesTorque, NamesOfAWrapper, changed);
SKINCTL_NAMES(ChangesMemory, NamesOfAWrapper, moved_on);
}  // namespace detail

/// Base of a law that is made of another one, `L`: everything that `L` has passes, and `Own` changes two
/// things, if it has the function:
/// - `changed<G>(tau, memory, known, share, now)`: the torque in place of L's, `tau` [N m]. G is included in
///   it if the `GravityTerm` says so; `share` holds the factors of its two parts; `now` is what L's `now`
///   gives;
/// - `moved_on(memory, known, dt, opposition, now)`: its own part of the memory after `dt`, in place.
///
/// `Own` has a `Memory` that derives from that of `L`; what it adds starts as in `Memory{}`. Constants
/// (`needs`, `name`) and functions that only read the memory (`settled`, `status`) can be hidden by its own.
///
///     struct Halved : WrappedLaw<Halved, MyLaw> {
///       struct Memory : MyLaw::Memory { double work = 0; };
///       template <GravityTerm G>
///       auto changed(const auto& tau, const auto&...) const noexcept { return 0.5 * tau; }
///     };
template <class Own, LawMembers L>
class WrappedLaw : public L {
 public:
  using WrappedType = L;

  [[nodiscard]] SKINCTL_INLINE const L& wrapped() const noexcept { return *this; }

  template <class K, class Self = Own>
  [[nodiscard]] typename Self::Memory start(const K& known) const noexcept {
    typename Self::Memory memory{};
    of(memory) = wrapped().start(known);
    return memory;
  }
  template <class K, class Self = Own>
    requires detail::HasResumed<L, K>
  [[nodiscard]] typename Self::Memory resumed(const typename Self::Memory& memory,
                                              const K& known) const noexcept {
    typename Self::Memory out = memory;
    of(out) = wrapped().resumed(of(out), known);
    return out;
  }
  template <class K, class G = typename LawTable<L>::Goal, class Self = Own>
    requires detail::Receives<L, K, G>
  [[nodiscard]] Received<typename Self::Memory> receive(const typename Self::Memory& memory, const K& known,
                                                        const G& goal) const noexcept {
    return with<Self>(memory, wrapped().receive(memory, known, goal));
  }
  template <class K, class G = typename LawTable<L>::Goal, class Self = Own>
    requires detail::Follows<L, K, G>
  [[nodiscard]] Received<typename Self::Memory> follow(const typename Self::Memory& memory, const K& known,
                                                       const G& goal) const noexcept {
    return with<Self>(memory, wrapped().follow(memory, known, goal));
  }

  template <GravityTerm G = GravityTerm::included, class K, class Now, class Self = Own>
    requires detail::HasNow<L, K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const typename Self::Memory& memory, const K& known, const LawShare<typename K::scalar>& share,
      const Now& now) const noexcept {
    return changed_from<G, Self>(detail::torque_with<G>(wrapped(), memory, known, share, now), memory, known,
                                 share, now);
  }
  template <GravityTerm G = GravityTerm::included, class K, class Self = Own>
    requires detail::TakesShare<L, K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const typename Self::Memory& memory, const K& known,
      const LawShare<typename K::scalar>& share = {}) const noexcept {
    const auto now = detail::now_of(wrapped(), memory, known);
    return changed_from<G, Self>(detail::torque_with<G>(wrapped(), memory, known, share, now), memory, known,
                                 share, now);
  }
  template <class K, class Self = Own>
    requires(!detail::TakesShare<L, K>)
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const typename Self::Memory& memory, const K& known) const noexcept {
    return changed_from<GravityTerm::included, Self>(torque_of(wrapped(), memory, known), memory, known,
                                                     LawShare<typename K::scalar>{}, detail::Nothing{});
  }

  template <class K, class Now, class Self = Own>
  [[nodiscard]] SKINCTL_INLINE typename Self::Memory advance(const typename Self::Memory& memory,
                                                             const K& known, const typename K::scalar& dt,
                                                             Opposition opposition,
                                                             const Now& now) const noexcept {
    typename Self::Memory next = memory;
    of(next) = detail::advance_with(wrapped(), memory, known, dt, opposition, now);
    if constexpr (detail::ChangesMemory<Self>) self<Self>().moved_on(next, known, dt, opposition, now);
    return next;
  }
  template <class K, class Self = Own>
  [[nodiscard]] SKINCTL_INLINE typename Self::Memory advance(const typename Self::Memory& memory,
                                                             const K& known, const typename K::scalar& dt,
                                                             Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, detail::now_of(wrapped(), memory, known));
  }

  template <class K, class Self = Own>
  [[nodiscard]] SKINCTL_INLINE auto evaluate(const typename Self::Memory& memory, const K& known,
                                             const typename K::scalar& dt) const noexcept {
    using Result = Evaluation<K::joints, typename K::scalar, typename Self::Memory, terms_of<L>>;
    if constexpr (terms_of<L> == 1) {
      return detail::evaluate_apart<Result>(self<Self>(), memory, known, dt);
    } else {
      static_assert(
          !detail::ChangesTorque<Self>,
          "a wrapper that changes the torque of several laws has an evaluate of its own: the shares add up "
          "to the torque");
      const auto own = skinctl::evaluate(wrapped(), memory, known, dt);
      Result out{own.torque, memory, own.shares, own.status};
      of(out.memory) = own.memory;
      if constexpr (detail::ChangesMemory<Self>)
        self<Self>().moved_on(out.memory, known, dt, Opposition::none, detail::Nothing{});
      return out;
    }
  }

 protected:
  explicit WrappedLaw(const L& law) : L(law) {}
  /// The wrapped law's part of a memory.
  template <class Memory>
  [[nodiscard]] static SKINCTL_INLINE typename L::Memory& of(Memory& memory) noexcept {
    return memory;
  }

 private:
  template <class Self>
  [[nodiscard]] SKINCTL_INLINE const Self& self() const noexcept {
    return static_cast<const Self&>(*this);
  }
  template <class Self>
  [[nodiscard]] static Received<typename Self::Memory> with(
      typename Self::Memory memory, const Received<typename L::Memory>& answer) noexcept {
    of(memory) = answer.memory;
    return {memory, answer.status};
  }
  template <GravityTerm G, class Self, class Torque, class K, class Now>
  [[nodiscard]] SKINCTL_INLINE Torque changed_from(const Torque& tau, const typename Self::Memory& memory,
                                                   const K& known, const LawShare<typename K::scalar>& share,
                                                   const Now& now) const noexcept {
    if constexpr (detail::ChangesTorque<Self>) {
      return self<Self>().template changed<G>(tau, memory, known, share, now);
    } else {
      return tau;
    }
  }
};

SKINCTL_END_NAMESPACE
#pragma GCC diagnostic pop
