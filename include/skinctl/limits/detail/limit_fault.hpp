// SPDX-License-Identifier: BSD-3-Clause
// Finds the fault of a limit that violates the protocol: a member that is missing, or that has a wrong
// signature.
#pragma once

#include "skinctl/core/detail/named_twice.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/tactile/coverage.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

struct NamesOfALimit {
  int share, within, keeps, look, stays, see, stand_off, links, reason;
};
SKINCTL_NAMES(NamesShare, NamesOfALimit, share);
SKINCTL_NAMES(NamesWithin, NamesOfALimit, within);
SKINCTL_NAMES(NamesKeeps, NamesOfALimit, keeps);
SKINCTL_NAMES(NamesLook, NamesOfALimit, look);
SKINCTL_NAMES(NamesStays, NamesOfALimit, stays);
SKINCTL_NAMES(NamesSee, NamesOfALimit, see);
SKINCTL_NAMES(NamesStandOff, NamesOfALimit, stand_off);
SKINCTL_NAMES(NamesLinks, NamesOfALimit, links);
SKINCTL_NAMES(NamesReason, NamesOfALimit, reason);

/// The touch of any scene, as limits see it: the members of `Seen`.
template <class T>
struct AnySeen {
  struct Pressed;
  Nanoseconds now;
  [[nodiscard]] const Pressed& pressed() const noexcept;
  template <std::size_t>
  [[nodiscard]] T max_proximity() const noexcept;
  [[nodiscard]] Coverage coverage() const noexcept;
  [[nodiscard]] double noticed(std::size_t) const noexcept;
  [[nodiscard]] bool touched() const noexcept;
};

/// Faults of a limit.
enum class LimitFault {
  none,
  memory,
  heavy_memory,
  precedence,
  share,
  within,
  reason,
  keeps,
  look,
  stays,
  see,
  input,
  stand_off,
  links,
  idle
};
/// The first fault of a limit, for a robot of N joints whose motion is a `Going`.
template <class L, class Going, std::size_t N, class T>
consteval LimitFault fault_in_limit() {
  using enum LimitFault;
  if constexpr (!LimitWithMemory<L>) {
    return memory;
  } else if constexpr (!LimitWithPrecedence<L>) {
    return precedence;
  } else {
    using U = JointVelocity<N, T>;
    using Q = JointPosition<N, T>;
    using Seen = AnySeen<T>;
    constexpr bool slows = Shares<L, Going, Seen, U>, turns = Turns<L, Going, U>;
    if (!std::is_trivially_copyable_v<typename L::Memory>) return heavy_memory;
    if (NamesShare<L> && !slows && !turns) return share;
    if (NamesWithin<L> && !slows && !LimitsTorque<L> && !NamesReason<L>) return reason;
    if (NamesWithin<L> && !slows && !LimitsTorque<L> && !turns) return within;
    if (NamesKeeps<L> && !Keeps<L, Going, U, Q>) return keeps;
    if (NamesLook<L> && !Looks<L, Seen, T>) return look;
    if (NamesStays<L> && !Stays<L>) return stays;
    if (NamesSee<L> && !NamesInput<L>) return input;
    if constexpr (LimitWithInput<L>)
      if (!Sees<L, Q>) return see;
    if (NamesStandOff<L> && !StandsOff<L, Q>) return stand_off;
    if (NamesLinks<L> && !ReadsTouch<L>) return links;
    const bool acts = slows || turns || Looks<L, Seen, T> || Stays<L> || DecidesMotion<L> || LimitsTorque<L>;
    return acts ? none : idle;
  }
}
/// Reports the fault `F` of a limit at compile time.
template <LimitFault F, class Limit>
struct SayLimit {
  using enum LimitFault;
  static_assert(
      F != memory,
      "a limit has a Memory, if only an empty one; one of skinctl: include its header, limits/...hpp");
  static_assert(F != heavy_memory, "the Memory of a limit is trivially copyable");
  static_assert(F != precedence, "a limit has a Precedence, its place among the others");
  static_assert(F != share, "limit: share(memory, going, seen, u) has to give a SpeedShare");
  static_assert(F != within, "limit: within(memory, going, u, also) has to give a KeptVelocity");
  static_assert(F != reason, "limit: within needs a Reason: static constexpr Reason reason");
  static_assert(F != keeps,
                "limit: keeps(memory, going, v, moved) has to give a bool, beside a Reason reason");
  static_assert(F != look, "limit: look(memory, seen, dt) has to give a Status");
  static_assert(F != stays, "limit: stays(memory) has to give a bool, of a const memory");
  static_assert(F != see, "limit with Input: see(memory, input, q, now)");
  static_assert(F != input,
                "limit: see(memory, input, q, now) needs a type Input, which it adds to the scene's");
  static_assert(F != stand_off, "limit: stand_off(memory, off)");
  static_assert(F != links, "limit: links has to be a LinkMask");
  static_assert(F != idle, "this limit limits nothing: it has neither share nor within, look or stays");
};

}  // namespace detail
SKINCTL_END_NAMESPACE
