// SPDX-License-Identifier: BSD-3-Clause
// The part of Blended that runs in every cycle.
#pragma once

#include <memory>

#include "skinctl/fusion/detail/blend_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of a `Blended` that evaluates its laws and adds them up.
template <Sum P, class... L>
class BlendLoop : public BlendMemory<P, L...> {
  using Base = BlendMemory<P, L...>;

 public:
  using Base::factors;
  static constexpr bool gated = Base::gated;
  static constexpr bool holds_gravity = Base::holds_gravity;
  using Base::loaded;
  using Base::moves;
  static constexpr std::size_t terms = Base::terms;
  using Fusion = typename Base::Fusion;
  using Factors = typename Base::Factors;
  using Memory = typename Base::Memory;

  [[nodiscard]] const Fusion& sum() const noexcept { return sum_; }

 protected:
  template <std::size_t Ix>
  using law_at = typename Base::template law_at<Ix>;
  using Base::has_share;
  using Base::target;

  BlendLoop(const Fusion& sum, const std::array<double, terms>& first, const skinctl::Ramp<double>& ramp,
            const ContactDetector& contact)
      : sum_(sum), first_(first), ramp_(ramp), contact_(contact) {}
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE const law_at<Ix>& law() const noexcept {
    return std::get<Ix>(sum_.laws());
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept {
    using T = typename K::scalar;
    Evaluation<K::joints, T, Memory, terms> out{{}, memory, {}, {}};
    Memory& next = out.memory;
    if (memory.waiting && !moves(memory)) [[unlikely]]
      next = begun(memory, known);
    const Factors shares = factors(next);
    JointTorque<K::joints, T> skin, track, contact;
    const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
      std::tuple<Part<typename NowOf<law_at<Ix>, K>::type, K::joints, T>...> parts;
      each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA {
        constexpr std::size_t J = i.value;
        constexpr LawRole r = law_at<J>::role;
        const bool on = loaded(next, J);
        if (!on && !(gated && LawTable<law_at<J>>::answers_touch)) return;
        if constexpr (r == LawRole::tracking)
          if (Base::comes(next, J) && next.elapsed < next.ramp) [[unlikely]]
            memory_of<J>(next.laws) = law<J>().start(known);
        auto& part = std::get<J>(parts);
        compute<J>(part, next, known, shares[J]);
        if constexpr (r == LawRole::tracking && !LawTable<law_at<J>>::presses) {
          track += part.torque;
          if constexpr (Fusion::watches && holds_gravity)
            track -= static_cast<T>(shares[J].feed_forward) * known.gravity();
        } else if constexpr (r == LawRole::reactive) {
          if constexpr (gated && LawTable<law_at<J>>::answers_touch)
            contact += static_cast<T>(sum_.weights()[J]) * part.torque;
          part.torque = static_cast<T>(shares[J].feedback) * part.torque;
          if constexpr (LawTable<law_at<J>>::answers_touch) skin += part.torque;
        }
        out.shares[J] = part.torque;
        out.torque += part.torque;
        if (on) out.status |= status_of(law<J>(), memory_of<J>(next.laws));
      });
      if constexpr (holds_gravity) {
        double left = 1;
        for (std::size_t i = 0; i < terms; ++i)
          if (Fusion::roles[i] == LawRole::tracking) left -= shares[i].feed_forward;
        out.torque += static_cast<T>(left) * known.gravity();
      }
      Opposition opposition = given;
      if constexpr (Fusion::watches) {
        const auto found = sum_.detector().detect(memory.opposition, skin, track, torque_scale(known), dt);
        next.opposition = found.memory;
        if (given == Opposition::none) opposition = found.opposition;
        if (opposition == Opposition::lasting) out.status |= Reason::opposed;
      }
      each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA {
        constexpr std::size_t J = i.value;
        if constexpr (!std::is_empty_v<typename law_at<J>::Memory>)
          if (Base::loaded(next, J)) move_on<J>(next, std::get<J>(parts).now, known, dt, opposition);
      });
    }(std::index_sequence_for<L...>{});
    if (moves(next)) out.status |= Reason::bumpless_transfer;
    next.elapsed = later(next.elapsed, ns);
    if constexpr (gated) {
      next.contact = contact_.advanced(next.contact, contact, ns);
      if (next.contact.touched != memory.contact.touched) {
        next.waiting = true;
        next.next_ramp = ramp_.duration();
      }
    }
    return out;
  }
  /// The memory at the beginning of a change to other shares; laws that had none start.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory begun(const Memory& memory, const K& known) const noexcept {
    Memory next = memory;
    next.from = memory.to;
    next.to = target(memory);
    next.elapsed = 0ns;
    next.ramp = memory.next_ramp;
    next.settle = 0ns;
    next.waiting = false;
    each_index<terms>([&](auto i) {
      if (!has_share(next.to[i]) || has_share(next.from[i])) return;
      if (Fusion::roles[i] == LawRole::tracking) next.settle = next.ramp;
      memory_of<i.value>(next.laws) = law<i.value>().start(known);
    });
    return next;
  }

  Fusion sum_;
  std::array<double, terms> first_;
  skinctl::Ramp<double> ramp_;
  ContactDetector contact_;

 private:
  /// The torque of a law, and the quantities from which its memory will be computed.
  template <class Now, std::size_t N, class T>
  struct Part {
    JointTorque<N, T> torque;
    union {
      Now now;  ///< common terms of torque and memory, for loaded tracking laws
    };
    Part() noexcept {}
    Part(const Part& other) noexcept : torque(other.torque) {}
  };
  // Each law's code is a function of its own: several in one function take the compiler far longer.
  template <std::size_t Ix, class Now, class K>
  SKINCTL_NOINLINE void compute(Part<Now, K::joints, typename K::scalar>& out, const Memory& memory,
                                const K& known, const LawShare<double>& share) const noexcept {
    using T = typename K::scalar;
    const auto& part = memory_of<Ix>(memory.laws);
    if constexpr (law_at<Ix>::role == LawRole::tracking) {
      std::construct_at(&out.now, now_of(law<Ix>(), part, known));
      out.torque = torque_with<Fusion::gravity_term>(
          law<Ix>(), part, known,
          LawShare<T>{static_cast<T>(share.feedback), static_cast<T>(share.feed_forward)}, out.now);
    } else {
      out.torque = torque_of(law<Ix>(), part, known);
    }
  }
  template <std::size_t Ix, class Now, class K>
  SKINCTL_NOINLINE void move_on(Memory& next, const Now& now, const K& known, const typename K::scalar& dt,
                                Opposition opposition) const noexcept {
    auto& part = memory_of<Ix>(next.laws);
    part = advance_with(law<Ix>(), part, known, dt, opposition, now);
  }
  template <class Law, class K>
  struct NowOf {
    using type = Nothing;
  };
  template <class Law, class K>
    requires(Law::role == LawRole::tracking)
  struct NowOf<Law, K> {
    using type = decltype(now_of(std::declval<const Law&>(), std::declval<const typename Law::Memory&>(),
                                 std::declval<const K&>()));
  };
};

}  // namespace detail
SKINCTL_END_NAMESPACE
