// SPDX-License-Identifier: BSD-3-Clause
// The memory of a blend: its shares, and the change that is under way.
#pragma once

#include "skinctl/fusion/contact_gate.hpp"
#include "skinctl/fusion/detail/blend_goal.hpp"
#include "skinctl/fusion/fused.hpp"
#include "skinctl/trajectory/ramp.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class>
class Blended;
namespace detail {
template <Sum P, class... L>
class BlendLoop;

/// The memory of a `Blended`, and what follows from it alone.
template <Sum P, class... L>
class BlendMemory : public Composable {
 public:
  using Fusion = Fused<P, L...>;
  using Laws = std::tuple<L...>;
  static constexpr std::size_t joints = Fusion::joints;
  static constexpr std::size_t terms = Fusion::terms;
  static constexpr auto roles = Fusion::roles;
  static constexpr LawRole role = Fusion::role;
  static constexpr bool complete_sum = true;  ///< cannot be part of another sum
  static constexpr std::size_t gravity_laws = Fusion::gravity_laws;
  static constexpr bool gated = (false || ... || LawTable<L>::is_gated);
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
  template <HasGoal F>
  struct GoalOf<F> {
    using type = BlendGoal<typename F::Goal, terms>;
  };

 public:
  using Goal = typename GoalOf<Fusion>::type;
  using Factors = std::array<LawShare<double>, terms>;
  class Memory {
    friend BlendMemory;
    friend BlendLoop<P, L...>;
    friend Blended<Fusion>;
    Memories<typename L::Memory...> laws;
    OppositionDetector::Memory opposition;
    ContactDetector::Memory contact;
    std::array<double, terms> asked;  ///< requested weights
    Factors from, to;                 ///< shares before and after the ramp
    Nanoseconds elapsed = clock_end;  ///< time since the ramp began
    Nanoseconds ramp{};               ///< duration of the ramp
    Nanoseconds settle{};     ///< duration of the fade-in of new tracking laws' feedback after the ramp
    Nanoseconds next_ramp{};  ///< duration of the ramp of the next change
    bool waiting = false;     ///< a change of weights is waiting
  };
  template <std::size_t Ix>
  [[nodiscard]] static SKINCTL_INLINE constexpr const auto& memory(const Memory& m) noexcept {
    return memory_of<Ix>(m.laws);
  }

  /// The present factors of each law's two parts.
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
  /// Lets the feedback of new tracking laws fade in once more, if it has begun to.
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

 protected:
  template <std::size_t Ix>
  using law_at = std::tuple_element_t<Ix, std::tuple<L...>>;
  [[nodiscard]] static SKINCTL_INLINE bool has_share(const LawShare<double>& share) noexcept {
    return share.feedback > 0 || share.feed_forward > 0;
  }
  /// The shares of the requested weights with the gates as they are.
  [[nodiscard]] static Factors target(const Memory& memory) noexcept {
    std::array<double, terms> weights = memory.asked;
    each_index<terms>([&](auto i) {
      if constexpr (LawTable<law_at<i.value>>::is_gated)
        if ((law_at<i.value>::gate == TouchGate::touched) != memory.contact.touched) weights[i.value] = 0;
    });
    return Fusion::shares(weights);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
