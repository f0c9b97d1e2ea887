// SPDX-License-Identifier: BSD-3-Clause
// The reasons for limits, holds and refusals of a cycle.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>

#include "skinctl/core/config.hpp"

#ifdef Status  // a macro of Xlib.h; its headers take a type as well
#undef Status
using Status = int;
#endif

SKINCTL_BEGIN_NAMESPACE

/// A reason for a limit, hold or refusal in a cycle. The table `faults` of guard/faults.hpp has a row for
/// each: finder, reaction, way back and text.
enum class Reason : std::uint8_t {
  state_not_finite,
  state_stale,
  time_backwards,
  interval_too_long,
  interval_empty,
  sample_not_finite,
  sample_out_of_range,
  sample_stale,
  sample_unknown,
  torque_not_finite,
  torque_limited,
  position_limited,
  velocity_limited,
  acceleration_limited,
  step_limited,
  command_not_finite,
  outside_limits,
  blocked,
  displaced,
  lead_limited,
  opposed,
  goal_refused,
  configuration_refused,
  goal_stretched,
  bumpless_transfer,
  singular,
  slowed,
  jerk_limited,
  jerk_exceeded,
  tool_speed_limited,
  clearance_kept,
  state_out_of_range,
  packets_lost,
  contact_slowed,
  contact_force,
  contact_power,
  budget_overrun,
  work_skipped,
  consent_awaited,
  skill_refused,
  skill_finished,
  skill_failed,
  tank_empty,
  energy_held,
  stopping,
  skin_unheard,
  skin_blind,
  skin_incomplete,
  skin_slowed,
  skin_held,
  skin_stopped,
  start_refused,
  push_without_life,
  interval_too_short,
  memory_refused,
  touch_unanswered,
  count
};

/// What `status == reason` gives: no bool, in a word that names the remedy. A reason among others is
/// `status.has(reason)`; no other one, `status == Status(reason)`.
struct ReasonsAreAskedByHas {};

/// A set of reasons; empty means that everything went as configured. Trivially copyable.
class Status {
 public:
  constexpr Status() noexcept = default;
  constexpr Status(Reason r) noexcept : bits_(bit(r)) {}  // NOLINT: a reason is a status

  [[nodiscard]] constexpr bool has(Reason r) const noexcept { return (bits_ & bit(r)) != 0; }
  [[nodiscard]] constexpr bool any() const noexcept { return bits_ != 0; }
  constexpr Status& operator|=(Status s) noexcept {
    bits_ |= s.bits_;
    return *this;
  }
  friend constexpr Status operator|(Status a, Status b) noexcept { return a |= b; }
  /// The reasons that both sets hold.
  friend constexpr Status operator&(Status a, Status b) noexcept { return from_bits(a.bits_ & b.bits_); }
  /// The reasons of this set that `s` does not hold.
  [[nodiscard]] constexpr Status without(Status s) const noexcept { return from_bits(bits_ & ~s.bits_); }
  friend constexpr bool operator==(Status, Status) noexcept = default;
  /// Comparison with one reason, which is of no use: a status holds several.
  template <std::same_as<Reason> R>
  [[nodiscard]] constexpr ReasonsAreAskedByHas operator==(R) const noexcept {
    return {};
  }
  [[nodiscard]] constexpr std::uint64_t bits() const noexcept { return bits_; }
  [[nodiscard]] static constexpr Status from_bits(std::uint64_t bits) noexcept {
    Status s;
    s.bits_ = bits & (bit(Reason::count) - 1u);
    return s;
  }
  /// Calls `f(reason)` for each reason in the set.
  template <class F>
  constexpr void for_each(F&& f) const {
    for (std::uint64_t rest = bits_; rest != 0; rest &= rest - 1u)
      f(static_cast<Reason>(std::countr_zero(rest)));
  }

 private:
  static constexpr std::uint64_t bit(Reason r) noexcept {
    return std::uint64_t(1) << static_cast<unsigned>(r);
  }
  std::uint64_t bits_ = 0;
};
static_assert(static_cast<unsigned>(Reason::count) < 64, "one bit a reason");

SKINCTL_END_NAMESPACE
