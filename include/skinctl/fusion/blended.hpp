// A sum of laws whose weights change while it runs: by request, and by gates that contact opens and shuts.
#pragma once

#include <memory>

#include "skinctl/fusion/contact_gate.hpp"
#include "skinctl/fusion/detail/blend_goal.hpp"
#include "skinctl/fusion/fused.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Times and thresholds of a blend.
struct BlendSettings {
  Nanoseconds ramp = 100ms;   ///< duration of a change of weights
  ContactSettings contact{};  ///< the contact detector of the gates
};

template <class>
class Blended;

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
class Blended<Fused<P, L...>> : public Composable {
 public:
  using Fusion = Fused<P, L...>;
  using Laws = std::tuple<L...>;
  static constexpr std::size_t joints = Fusion::joints;
  static constexpr std::size_t terms = Fusion::terms;
  static constexpr auto roles = Fusion::roles;
  static constexpr LawRole role = Fusion::role;
  static constexpr bool complete_sum = true;  ///< cannot be part of another sum
  static constexpr std::size_t gravity_laws = Fusion::gravity_laws;
  static constexpr bool gated = (false || ... || detail::is_gated<L>);
  static constexpr bool compensates_friction = Fusion::compensates_friction;
  /// Whether the sum itself adds the missing part of G.
  static constexpr bool holds_gravity = Fusion::gravity_laws == 0 && Fusion::tracking_laws > 0;
  static_assert(!holds_gravity || P != Sum::plain, "a plain sum that blends needs a gravity law");
  static constexpr Needs needs = Fusion::needs | Needs{.gravity = holds_gravity};
  static_assert(!gated || Fusion::answers_touch, "a gate needs a law of the skin in its sum");

 private:
  template <class F>
  struct GoalOf {
    using type = BlendWeights<terms>;
  };
  template <class F>
    requires requires { typename F::Goal; }
  struct GoalOf<F> {
    using type = BlendGoal<typename F::Goal, terms>;
  };

 public:
  using Goal = typename GoalOf<Fusion>::type;
  using Factors = std::array<LawShare<double>, terms>;
  class Memory {
    friend Blended;
    detail::Memories<typename L::Memory...> laws;
    OppositionDetector::Memory opposition;
    ContactDetector::Memory contact;
    std::array<double, terms> asked;  ///< requested weights
    Factors from, to;                 ///< shares before and after the ramp
    Nanoseconds elapsed = clock_end;  ///< since the ramp began
    Nanoseconds ramp{};               ///< its duration
    Nanoseconds settle{};             ///< then: fade-in of the feedback of new tracking laws
    Nanoseconds next_ramp{};          ///< of the next change
    bool waiting = false;             ///< a change of weights is waiting
  };

  explicit Blended(const Fusion& sum, const BlendSettings& settings = {})
      : Blended(sum, sum.weights(), settings) {}
  /// @param first  weights to start with, >= 0. Throws `ConfigurationError`.
  Blended(const Fusion& sum, const std::array<double, terms>& first, const BlendSettings& settings = {})
      : sum_(sum), first_(first), ramp_(settings.ramp), contact_(settings.contact) {
    for (std::size_t i = 0; i < terms; ++i)
      require(usable(i, first[i]), "weight of a law", first[i], "0 to 1e6, and 1 for gravity");
  }
  [[nodiscard]] const Fusion& sum() const noexcept { return sum_; }
  template <class Terms>
  void check_for(const Terms& robot) const {
    sum_.check_for(robot);
  }
  /// The initial weights.
  [[nodiscard]] const std::array<double, terms>& first() const noexcept { return first_; }
  [[nodiscard]] Nanoseconds ramp() const noexcept { return ramp_.duration(); }
  template <std::size_t I>
  [[nodiscard]] static SKINCTL_INLINE constexpr const auto& memory(const Memory& m) noexcept {
    return detail::memory_of<I>(m.laws);
  }

  /// Begins with the initial weights, without contact.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory memory{};
    memory.asked = first_;
    memory.from = memory.to = target(memory);
    detail::each_index<terms>([&](auto i) {
      if (loaded(memory, i)) detail::memory_of<i.value>(memory.laws) = law<i.value>().start(known);
    });
    return memory;
  }

  /// Requests other weights within `ramp` (0: as configured). Refused if one is negative, not finite, or not
  /// 1 for gravity.
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
    return change(memory, known, weights);
  }
  /// A goal for the one law that takes goals of this type, or the next sample of a target that it follows;
  /// refused while that law has no share or fades in.
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
    if (goal.weights) out = change(memory, known, *goal.weights);
    if (!goal.goal) return out;
    const auto answer = receive(out.memory, known, *goal.goal);
    return {answer.memory, out.status | answer.status};
  }
  /// The same for the `I`-th law.
  template <std::size_t I, class K, class G>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const G& goal) const noexcept {
    if (!loaded(memory, I) || comes(memory, I)) return {memory, Reason::goal_refused};
    Received<Memory> out{memory, {}};
    auto& part = detail::memory_of<I>(out.memory.laws);
    const auto answer = follow_or_receive(law<I>(), part, known, goal);
    part = answer.memory;
    out.status = answer.status;
    return out;
  }

  /// The factors of the laws' two parts.
  [[nodiscard]] static Factors factors(const Memory& memory) noexcept {
    if (!moves(memory)) return memory.to;
    const auto part = [](Nanoseconds t, Nanoseconds of) {
      return static_cast<double>(t.count()) / static_cast<double>(of.count());
    };
    const auto way = quintic(part(memory.elapsed, memory.ramp));
    const double late =
        memory.elapsed <= memory.ramp ? 0 : quintic(part(memory.elapsed - memory.ramp, memory.settle)).a1;
    Factors out;
    for (std::size_t i = 0; i < terms; ++i) {
      const auto &from = memory.from[i], &to = memory.to[i];
      const bool slowly =
          Fusion::roles[i] == LawRole::tracking && !has_share(from);  // it fades in, or has no share
      out[i] = {slowly ? late * to.feedback : way.rest * from.feedback + way.a1 * to.feedback,
                way.rest * from.feed_forward + way.a1 * to.feed_forward};
    }
    return out;
  }
  /// Whether the weights are changing.
  [[nodiscard]] static SKINCTL_INLINE bool moves(const Memory& memory) noexcept {
    return memory.elapsed < memory.ramp + memory.settle;
  }
  /// Whether the `i`-th law fades in from no share.
  [[nodiscard]] static SKINCTL_INLINE bool comes(const Memory& memory, std::size_t i) noexcept {
    return moves(memory) && !has_share(memory.from[i]) && has_share(memory.to[i]);
  }
  /// Whether the `i`-th law is computed.
  [[nodiscard]] static SKINCTL_INLINE bool loaded(const Memory& memory, std::size_t i) noexcept {
    return has_share(memory.to[i]) || (memory.elapsed < memory.ramp && has_share(memory.from[i]));
  }

  /// The weights are constant, and all laws that have a share are settled.
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known,
                             const typename K::scalar& still) const noexcept {
    return !moves(memory) && [&]<std::size_t... I>(std::index_sequence<I...>) {
      return ((!loaded(memory, I) ||
               skinctl::settled(law<I>(), detail::memory_of<I>(memory.laws), known, still)) &&
              ...);
    }(std::index_sequence_for<L...>{});
  }

  // For callers that time changes of weights themselves, such as a set of skills.
  /// The memory at the end of the change.
  [[nodiscard]] static Memory arrived(Memory memory) noexcept {
    memory.elapsed = clock_end;
    return memory;
  }
  /// Whether the feedback of new tracking laws fades in over a time of its own after the ramp.
  [[nodiscard]] static bool settles(const Memory& memory) noexcept { return memory.settle > 0ns; }
  /// Sets the durations of the change under way.
  static void set_times(Memory& memory, Nanoseconds ramp, Nanoseconds settle) noexcept {
    memory.ramp = ramp;
    if (settles(memory)) memory.settle = settle;
  }
  /// Lets only this part of the time between `before` and `next` pass for the change, 0 to 1.
  static void slow_down(const Memory& before, Memory& next, double part) noexcept {
    next.elapsed = before.elapsed + nanoseconds(seconds<double>(next.elapsed - before.elapsed) * part);
  }
  /// The feedback of new tracking laws fades in once more, if it has begun.
  static void settle_again(Memory& memory) noexcept {
    if (settles(memory) && memory.elapsed >= memory.ramp) memory.elapsed = memory.ramp - 1ns;
  }
  /// Whether the `i`-th law had no share before the change.
  [[nodiscard]] static bool is_new(const Memory& memory, std::size_t i) noexcept {
    return memory.from[i].feed_forward == 0;
  }
  /// Whether a change is under way that keeps no tracking law.
  [[nodiscard]] static bool swaps(const Memory& memory) noexcept {
    if (!moves(memory)) return false;
    for (std::size_t i = 0; i < terms; ++i)
      if (Fusion::roles[i] == LawRole::tracking && memory.from[i].feed_forward > 0 &&
          memory.to[i].feed_forward > 0)
        return false;
    return true;
  }
  /// Sets the targets of the tracking laws that had a share to the present state.
  template <class K>
  SKINCTL_COLD void restart(Memory& memory, const K& known) const noexcept {
    detail::each_index<terms>([&](auto i) {
      if constexpr (law_at<i.value>::role == LawRole::tracking)
        if (memory.from[i.value].feed_forward > 0)
          detail::memory_of<i.value>(memory.laws) = law<i.value>().start(known);
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
  template <std::size_t I>
  using law_at = std::tuple_element_t<I, std::tuple<L...>>;
  template <std::size_t I>
  [[nodiscard]] SKINCTL_INLINE const law_at<I>& law() const noexcept {
    return std::get<I>(sum_.laws());
  }
  [[nodiscard]] static bool usable(std::size_t i, double w) noexcept {
    return Fusion::roles[i] == LawRole::gravity ? w == 1.0 : w >= 0 && w <= 1e6;
  }
  [[nodiscard]] static SKINCTL_INLINE bool has_share(const LawShare<double>& share) noexcept {
    return share.feedback > 0 || share.feed_forward > 0;
  }
  /// The shares of the requested weights with the gates as they are.
  [[nodiscard]] static Factors target(const Memory& memory) noexcept {
    std::array<double, terms> weights = memory.asked;
    detail::each_index<terms>([&](auto i) {
      if constexpr (detail::is_gated<law_at<i.value>>)
        if ((law_at<i.value>::gate == TouchGate::touched) != memory.contact.touched) weights[i.value] = 0;
    });
    return Fusion::shares(weights);
  }
  /// The change to other shares begins; laws that had none start.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory begun(const Memory& memory, const K& known) const noexcept {
    Memory next = memory;
    next.from = memory.to;
    next.to = target(memory);
    next.elapsed = 0ns;
    next.ramp = memory.next_ramp;
    next.settle = 0ns;
    next.waiting = false;
    detail::each_index<terms>([&](auto i) {
      if (!has_share(next.to[i]) || has_share(next.from[i])) return;
      if (Fusion::roles[i] == LawRole::tracking) next.settle = next.ramp;
      detail::memory_of<i.value>(next.laws) = law<i.value>().start(known);
    });
    return next;
  }

  /// The torque of a law, and the quantities from which its memory will be computed.
  template <class Now, std::size_t N, class T>
  struct Part {
    JointTorque<N, T> torque;
    union {
      Now now;  ///< of loaded tracking laws
    };
    Part() noexcept {}
    Part(const Part& other) noexcept : torque(other.torque) {}
  };
  // Each law's code is a function of its own: several in one function take the compiler far longer.
  template <std::size_t I, class Now, class K>
  SKINCTL_NOINLINE void compute(Part<Now, K::joints, typename K::scalar>& out, const Memory& memory,
                                const K& known, const LawShare<double>& share) const noexcept {
    using T = typename K::scalar;
    const auto& part = detail::memory_of<I>(memory.laws);
    if constexpr (law_at<I>::role == LawRole::tracking) {
      std::construct_at(&out.now, detail::now_of(law<I>(), part, known));
      out.torque = detail::torque_with<Fusion::gravity_term>(
          law<I>(), part, known,
          LawShare<T>{static_cast<T>(share.feedback), static_cast<T>(share.feed_forward)}, out.now);
    } else {
      out.torque = torque_of(law<I>(), part, known);
    }
  }
  template <std::size_t I, class Now, class K>
  SKINCTL_NOINLINE void move_on(Memory& next, const Now& now, const K& known, const typename K::scalar& dt,
                                Opposition opposition) const noexcept {
    auto& part = detail::memory_of<I>(next.laws);
    part = detail::advance_with(law<I>(), part, known, dt, opposition, now);
  }
  template <class Law, class K>
  struct NowOf {
    using type = detail::Nothing;
  };
  template <class Law, class K>
    requires(Law::role == LawRole::tracking)
  struct NowOf<Law, K> {
    using type = decltype(detail::now_of(
        std::declval<const Law&>(), std::declval<const typename Law::Memory&>(), std::declval<const K&>()));
  };

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept;

  Fusion sum_;
  std::array<double, terms> first_;
  Ramp<double> ramp_;
  ContactDetector contact_;
};

/// The same sum with variable weights, and gates.
template <Sum P, class... L>
[[nodiscard]] Blended<Fused<P, L...>> blended(const Fused<P, L...>& sum, const BlendSettings& settings = {}) {
  return Blended<Fused<P, L...>>(sum, settings);
}

SKINCTL_END_NAMESPACE

#include "skinctl/fusion/detail/blend_loop.hpp"
