// SPDX-License-Identifier: BSD-3-Clause
// Activities as plans see them: what must hold, what they change, how long they may take. No robot in it.
#pragma once

#include <concepts>
#include <cstdint>

#include "skinctl/core/time.hpp"
#include "skinctl/semantics/words.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A set of facts, one bit each.
struct Facts {
  std::uint32_t bits = 0;

  /// Whether all of `others` are among these facts.
  [[nodiscard]] constexpr bool has(Facts others) const noexcept { return (others.bits & ~bits) == 0; }
  [[nodiscard]] constexpr bool any() const noexcept { return bits != 0; }
  friend constexpr Facts operator|(Facts a, Facts b) noexcept { return {a.bits | b.bits}; }
  friend constexpr Facts operator&(Facts a, Facts b) noexcept { return {a.bits & b.bits}; }
  /// The facts of `a` that are not in `b`.
  friend constexpr Facts operator-(Facts a, Facts b) noexcept { return {a.bits & ~b.bits}; }
  friend constexpr bool operator==(Facts, Facts) noexcept = default;
};

/// The facts of the library's activities. An application's own are `fact::own<0>` to `fact::own<15>`.
namespace fact {
inline constexpr Facts none{};
inline constexpr Facts seen{1u << 0};     ///< the place of the object is known
inline constexpr Facts above{1u << 1};    ///< the hand stands above the object
inline constexpr Facts around{1u << 2};   ///< the open hand is around the object
inline constexpr Facts in_hand{1u << 3};  ///< the object is between the fingers
inline constexpr Facts carried{1u << 4};  ///< the object in hand has been moved
inline constexpr Facts good{1u << 5};     ///< the object in hand is judged good
inline constexpr Facts bad{1u << 6};      ///< the object in hand is judged bad
inline constexpr Facts there{1u << 7};    ///< the hand is where the object shall be put
inline constexpr Facts placed{1u << 8};   ///< the object has been put down
inline constexpr Facts marked{1u << 9};   ///< the place of the landmark is known
template <unsigned K>
  requires(K < 16)
inline constexpr Facts own{1u << (16 + K)};
}  // namespace fact

/// The facts that are seen of the world at an instant, without asking a plan.
struct Observed {
  Facts told{};  ///< the facts that the sensors tell, whether they hold or not
  Facts hold{};  ///< the told facts that hold
};
/// The facts that features tell: `in_hand` and `carried`. Nothing where the signals do not suffice.
[[nodiscard]] constexpr Observed observed(const Features& f) noexcept {
  if (!f.known) return {};
  const Facts held = f.in_hand ? fact::in_hand : fact::none, carried = f.carried ? fact::carried : fact::none;
  return {fact::in_hand | fact::carried, held | carried};
}
/// `seen` with the facts `fact` of another sensor, for instance a detector: they are told, and hold or not.
[[nodiscard]] constexpr Observed also(const Observed& seen, Facts fact, bool holds) noexcept {
  return {seen.told | fact, holds ? seen.hold | fact : seen.hold - fact};
}

/// The conditions of an activity, and its effects on the facts.
struct ActivityRule {
  const char* name = "";
  Activity word = Activity::unknown;  ///< activity that a recogniser reports when somebody does it
  Facts needs{};              ///< facts that hold from begin to end of the activity, unless it removes them
  Facts forbids{};            ///< facts that do not hold when the activity begins
  Facts adds{};               ///< facts that hold when the activity is done
  Facts removes{};            ///< facts that hold no more when the activity is done, with either answer
  Facts adds_if_no{};         ///< facts that hold instead of `adds` when the answer at the end is no
  Nanoseconds timeout = 20s;  ///< time after which the activity has failed
  std::uint8_t retries = 1;   ///< number of new attempts after a failure, before the plan goes back
};

/// The type of an activity: `struct Turn { static constexpr ActivityRule rule{...}; };`. It is a key of a
/// robot's map to behaviours.
template <class A>
concept PlannedActivity = requires {
  { A::rule } -> std::same_as<const ActivityRule&>;
};

/// The activities of the library; section 6 of the paper.
namespace activity {
struct Look {  ///< looks for an object of the step's role; answer no: there is none
  static constexpr ActivityRule rule{.name = "look", .adds = fact::seen, .timeout = 2s, .retries = 2};
};
struct ReachAbove {
  static constexpr ActivityRule rule{.name = "reach_above",
                                     .word = Activity::reach,
                                     .needs = fact::seen,
                                     .forbids = fact::in_hand,
                                     .adds = fact::above,
                                     .timeout = 10s};
};
struct Reach {
  static constexpr ActivityRule rule{.name = "reach",
                                     .word = Activity::reach,
                                     .needs = fact::seen | fact::above,
                                     .forbids = fact::in_hand,
                                     .adds = fact::around,
                                     .removes = fact::above,
                                     .timeout = 10s};
};
struct Take {
  static constexpr ActivityRule rule{.name = "take",
                                     .word = Activity::take,
                                     .needs = fact::around,
                                     .forbids = fact::in_hand,
                                     .adds = fact::in_hand,
                                     .removes = fact::seen | fact::around,
                                     .timeout = 4s};
};
struct Squeeze {  ///< squeezes the object to judge it; answer no: it is bad
  static constexpr ActivityRule rule{.name = "squeeze",
                                     .word = Activity::squeeze,
                                     .needs = fact::in_hand,
                                     .adds = fact::good,
                                     .removes = fact::bad,
                                     .adds_if_no = fact::bad,
                                     .timeout = 6s,
                                     .retries = 0};
};
struct Put {  ///< carries the object to a place
  static constexpr ActivityRule rule{
      .name = "put", .word = Activity::put, .needs = fact::in_hand, .adds = fact::there, .timeout = 15s};
};
struct Find {  ///< looks for the landmark of the step's place
  static constexpr ActivityRule rule{.name = "find", .adds = fact::marked, .timeout = 2s, .retries = 2};
};
struct Carry {  ///< brings the object to where something is done with it
  static constexpr ActivityRule rule{.name = "carry",
                                     .word = Activity::put,
                                     .needs = fact::in_hand,
                                     .adds = fact::carried,
                                     .removes = fact::there,
                                     .timeout = 15s};
};
struct Use {  ///< uses the tool in hand, by the motion of its use
  static constexpr ActivityRule rule{.name = "use",
                                     .word = Activity::use,
                                     .needs = fact::in_hand | fact::carried,
                                     .removes = fact::there | fact::marked,
                                     .timeout = 30s};
};
struct Release {
  static constexpr ActivityRule rule{
      .name = "release",
      .word = Activity::release,
      .needs = fact::in_hand | fact::there,
      .adds = fact::placed,
      .removes = fact::in_hand | fact::carried | fact::there | fact::good | fact::bad | fact::marked,
      .timeout = 4s};
};
struct Reverse {  ///< goes up and opens the hand: the way back of a plan
  static constexpr ActivityRule rule{.name = "reverse", .timeout = 10s, .retries = 0};
};
}  // namespace activity

SKINCTL_END_NAMESPACE
