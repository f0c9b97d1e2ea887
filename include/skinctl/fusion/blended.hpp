// SPDX-License-Identifier: BSD-3-Clause
// A sum of laws whose weights change while it runs: by request, and by gates that contact opens and shuts.
#pragma once

#include "skinctl/fusion/detail/blend_loop.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Times and thresholds of a blend.
struct BlendSettings {
  Nanoseconds ramp = 100ms;   ///< duration of a change of weights
  ContactSettings contact{};  ///< the contact detector of the gates
};

/// A sum with variable weights, made by `blended(sum)`.
///
/// - Weights change by request (`change`, or a goal of type `BlendWeights`); gates follow contact. A quintic
///   leads from the present shares to those that the policy computes from the new weights: torque, its rate
///   and its second derivative are continuous. All shares on the way are means of both ends, so that
///   `Y_r Theta` stays one convex mean.
/// - A change requested during another waits for its end; of several, the last counts.
/// - A law without a share is not computed. While its share grows, the target of a tracking law is the
///   present state, anew in every cycle: it brakes the robot and pulls it nowhere. After the change its
///   feedback fades in over a ramp of the same duration, so that an external push is taken up gradually; then
///   it accepts goals.
/// - Gravity is compensated once and whole throughout: where no gravity law is in the sum and tracking fades,
///   the sum adds the missing part of G.
template <Sum P, class... L>
class Blended<Fused<P, L...>> : public detail::BlendLoop<P, L...>,
                                public detail::SeeingLaws<Blended<Fused<P, L...>>, L...> {
  using Loop = detail::BlendLoop<P, L...>;
  template <std::size_t Ix>
  using law_at = typename Loop::template law_at<Ix>;
  using Loop::begun;
  using Loop::contact_;
  using Loop::first_;
  using Loop::ramp_;
  using Loop::step;
  using Loop::sum_;
  using Loop::target;

 public:
  using Loop::comes;
  using Loop::loaded;
  using Loop::moves;
  using Loop::terms;
  using Fusion = typename Loop::Fusion;
  using Goal = typename Loop::Goal;
  using Memory = typename Loop::Memory;

  explicit Blended(const Fusion& sum, const BlendSettings& settings = {})
      : Blended(sum, sum.weights(), settings) {}
  /// @param first  weights to start with, 0 to 1e6, and 1 for gravity. Throws `ConfigurationError` for
  ///               others.
  Blended(const Fusion& sum, const std::array<double, terms>& first, const BlendSettings& settings = {})
      : Loop(sum, first, Ramp<double>(settings.ramp), ContactDetector(settings.contact)) {
    for (std::size_t i = 0; i < terms; ++i)
      require(usable(i, first[i]), "weight of a law", first[i], "0 to 1e6, and 1 for gravity");
  }
  template <class Terms>
  void check_for(const Terms& robot) const {
    sum_.check_for(robot);
  }
  [[nodiscard]] const std::tuple<L...>& laws() const noexcept { return sum_.laws(); }
  /// Calls `f(law, its memory)` for each law.
  template <class BlendMemory, class F>
  SKINCTL_INLINE void each_law(BlendMemory& memory, F&& f) const noexcept {
    detail::each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA {
      f(this->template law<i.value>(), detail::memory_of<i.value>(memory.laws));
    });
  }
  /// The initial weights.
  [[nodiscard]] const std::array<double, terms>& first() const noexcept { return first_; }
  [[nodiscard]] Nanoseconds ramp() const noexcept { return ramp_.duration(); }

  /// The memory with which the blend starts: with the initial weights, without contact.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory memory{};
    memory.asked = first_;
    memory.from = memory.to = target(memory);
    detail::each_index<terms>([&](auto i) {
      if (loaded(memory, i))
        detail::memory_of<i.value>(memory.laws) = this->template law<i.value>().start(known);
    });
    return memory;
  }

  /// The memory after a request for other weights within `ramp` (0: as configured). Refused if one is
  /// negative, not finite, above 1e6, or not 1 for gravity.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> change(const Memory& memory, const K& known,
                                                     const BlendWeights<terms>& weights,
                                                     Nanoseconds ramp = {}) const noexcept {
    for (std::size_t i = 0; i < terms; ++i)
      if (!usable(i, weights.of[i])) return {memory, Reason::goal_refused};
    Memory next = memory;
    next.asked = weights.of;
    next.next_ramp = ramp > 0ns ? ramp : ramp_.duration();
    next.waiting = true;
    return {moves(memory) ? next : begun(next, known), {}};
  }
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const BlendWeights<terms>& weights) const noexcept {
    if (weights.of == memory.asked) return {memory, {}};  // a request in every cycle is one
    return change(memory, known, weights);
  }
  /// The memory after a goal for the one law that takes goals of this type, or after the next sample of a
  /// target that it follows; refused while that law has no share or fades in.
  template <class K, class G>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known, const G& goal) const noexcept {
    constexpr std::size_t i = Fusion::template taker<G>();
    static_assert(i < terms, "no law, or more than one, takes such a goal: receive<I>(memory, known, goal)");
    return receive<i>(memory, known, goal);
  }
  template <class K, class G>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const BlendGoal<G, terms>& goal) const noexcept {
    Received<Memory> out{memory, {}};
    if (goal.weights) out = receive(memory, known, *goal.weights);
    if (!goal.goal) return out;
    const auto answer = receive(out.memory, known, *goal.goal);
    return {answer.memory, out.status | answer.status};
  }
  /// The memory after a goal for the `Ix`-th law, or after the next sample of a target that it follows;
  /// refused while that law has no share or fades in.
  template <std::size_t Ix, class K, class G>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const G& goal) const noexcept {
    if (!loaded(memory, Ix) || comes(memory, Ix)) return {memory, Reason::goal_refused};
    Received<Memory> out{memory, {}};
    auto& part = detail::memory_of<Ix>(out.memory.laws);
    const auto answer = follow_or_receive(this->template law<Ix>(), part, known, goal);
    part = answer.memory;
    out.status = answer.status;
    return out;
  }

  /// The reasons of all laws that have a share, `opposed` while skin and tracking are, and
  /// `bumpless_transfer` while weights change.
  [[nodiscard]] Status status(const Memory& memory) const noexcept {
    Status out;
    detail::each_index<terms>([&](auto i) {
      if (loaded(memory, i))
        out |= status_of(this->template law<i.value>(), detail::memory_of<i.value>(memory.laws));
    });
    if (memory.opposition.opposed) out |= Reason::opposed;
    if (moves(memory)) out |= Reason::bumpless_transfer;
    return out;
  }
  /// Whether the weights are constant, and all laws that have a share are settled.
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known,
                             const typename K::scalar& still) const noexcept {
    return !moves(memory) && [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      return ((!loaded(memory, Ix) || skinctl::settled(this->template law<Ix>(),
                                                       detail::memory_of<Ix>(memory.laws), known, still)) &&
              ...);
    }(std::index_sequence_for<L...>{});
  }
  /// The memory after a stop: of the laws that have a share.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory resumed(const Memory& memory, const K& known) const noexcept {
    Memory out = memory;
    detail::each_index<terms>([&](auto i) {
      auto& part = detail::memory_of<i.value>(out.laws);
      if (loaded(memory, i)) part = skinctl::resumed(this->template law<i.value>(), part, known);
    });
    return out;
  }
  /// Sets the targets of the tracking laws that had a share to the present state.
  template <class K>
  SKINCTL_COLD void restart(Memory& memory, const K& known) const noexcept {
    detail::each_index<terms>([&](auto i) {
      if constexpr (law_at<i.value>::role == LawRole::tracking)
        if (memory.from[i.value].feed_forward > 0)
          detail::memory_of<i.value>(memory.laws) = this->template law<i.value>().start(known);
    });
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const Memory& memory, const K& known) const noexcept {
    return evaluate(memory, known, known.dt()).torque;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known,
                                              const typename K::scalar& dt,
                                              Opposition opposition) const noexcept {
    return step(memory, known, dt, opposition).memory;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto evaluate(const Memory& memory, const K& known,
                                             const typename K::scalar& dt,
                                             Opposition opposition = Opposition::none) const noexcept {
    return step(memory, known, dt, opposition);
  }

 private:
  [[nodiscard]] static bool usable(std::size_t i, double w) noexcept {
    return Fusion::roles[i] == LawRole::gravity ? w == 1.0 : w >= 0 && w <= 1e6;
  }
};

/// `sum` with variable weights, and gates.
template <Sum P, class... L>
[[nodiscard]] Blended<Fused<P, L...>> blended(const Fused<P, L...>& sum, const BlendSettings& settings = {}) {
  return Blended<Fused<P, L...>>(sum, settings);
}

SKINCTL_END_NAMESPACE
