// What a cycle limited, held or refused, and why.
#pragma once

#include <bit>
#include <cstdint>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One reason. The texts that `describe` gives say what was done about it.
enum class Reason : std::uint8_t {
  state_not_finite,      ///< the robot reported NaN or infinity: the last good state stands
  state_stale,           ///< no new state for longer than configured: the command brakes and holds
  time_backwards,        ///< a stamp lies before the last one: the sample is refused
  interval_too_long,     ///< the cycle came later than the longest interval it may integrate: the rest is
                         ///< dropped
  interval_empty,        ///< no time has passed since the last cycle: the command repeats
  sample_not_finite,     ///< a cell sent NaN or infinity: the sample is refused
  sample_out_of_range,   ///< a cell sent a reading that the sensor cannot give: the sample is refused
  sample_stale,          ///< a cell has been silent for too long: it does not push
  sample_unknown,        ///< a sample of a cell that no patch holds: refused
  samples_overflow,      ///< more samples than a cycle takes: the oldest are merged
  torque_not_finite,     ///< a law gave NaN or infinity: zero torque for this sub-step
  torque_limited,        ///< the fused torque was cut to its limit
  position_limited,      ///< a joint was stopped at its position limit
  velocity_limited,      ///< a joint's velocity was cut to its limit
  acceleration_limited,  ///< a joint's acceleration was cut to its limit
  step_limited,          ///< the command would have stepped further than the guard allows
  command_not_finite,    ///< the guard saw NaN or infinity: the last command is held
  outside_limits,        ///< the robot is beyond a limit: only motion inward is commanded
  blocked,               ///< the robot does not follow: the virtual robot went back to it
  lead_limited,          ///< the virtual robot was kept near the measured one
  opposed,               ///< skin and tracking push against each other: integrals and clock are frozen
  goal_refused,          ///< a goal was out of reach in the time given: the old one stands
  goal_stretched,        ///< a goal got more time than asked, to keep velocity limits
  bumpless_transfer,     ///< a difference of torque is being ramped out
  singular,              ///< a matrix could not be factorised: zero acceleration for this sub-step
  slowed,                ///< next to a singularity, or at the largest joint speed: the tool moves slower
  jerk_limited,          ///< a joint's jerk was cut to its limit
  jerk_exceeded,         ///< the jerk limit gave way: another limit could not be kept otherwise
  tool_speed_limited,    ///< all joints were slowed for the speed of the tool
  state_out_of_range,    ///< a joint sensor gave what the robot cannot do: the sample is refused
  packets_lost,          ///< too many packets in a row never came: the command brakes and holds
  contact_slowed,        ///< all joints were slowed for somebody near or in touch
  contact_force,         ///< a contact presses harder than configured: the command stops
  contact_power,         ///< a contact takes more power than configured: the command stops
  budget_overrun,        ///< cycles took longer than their budget: the command brakes and holds
  work_skipped,          ///< a cycle took longer than its budget: optional work should be left out
  consent_awaited,       ///< a fault is over, but only the user's `resume` ends its reaction
  skill_refused,         ///< a skill may not start now: the old one goes on
  skill_finished,        ///< the skill has done its work and holds
  skill_failed,          ///< the skill has failed: the one to fall back to comes
  tank_empty,            ///< the energy tank cannot pay for the active torques: they fade
  energy_held,           ///< moving on into a contact would cost more energy than it gave: held
  contact_damped,        ///< a contact oscillated: damping was added along it
  stopping,              ///< a stop was asked for or is being carried out
  count
};

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
  friend constexpr bool operator==(Status, Status) noexcept = default;
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

/// A reason in words, for logs.
constexpr const char* describe(Reason r) noexcept {
  constexpr const char* text[] = {
      "state not finite: the last good state stands",
      "state stale: braking and holding",
      "time went backwards: sample refused",
      "interval too long: the rest is dropped",
      "no time has passed: the command repeats",
      "sample not finite: refused",
      "sample out of range: refused",
      "sample stale: the cell does not push",
      "sample of an unknown cell: refused",
      "too many samples: the oldest are merged",
      "torque not finite: zero torque",
      "torque limited",
      "position limited",
      "velocity limited",
      "acceleration limited",
      "step limited",
      "command not finite: the last command is held",
      "outside the limits: only inward motion",
      "blocked: the robot does not follow",
      "lead limited: the virtual robot was kept near the measured one",
      "opposed: skin and tracking push against each other",
      "goal refused: the old one stands",
      "goal stretched in time",
      "bumpless transfer: a torque difference is being ramped out",
      "singular: zero acceleration",
      "slowed: next to a singularity, or at the largest speed of a joint",
      "jerk limited",
      "jerk limit gave way to another limit",
      "tool speed limited: all joints slowed",
      "state out of range: refused",
      "packets lost: braking and holding",
      "contact: all joints slowed for somebody near or in touch",
      "contact force above its limit: stopping",
      "contact power above its limit: stopping",
      "budget overrun: braking and holding",
      "budget overrun: optional work left out",
      "waiting for consent to go on",
      "skill refused: the old one goes on",
      "skill finished: it holds",
      "skill failed: falling back",
      "energy tank empty: active torques fade",
      "energy of the contact used up: held",
      "contact oscillated: damped",
      "stopping",
  };
  static_assert(sizeof text / sizeof *text == static_cast<unsigned>(Reason::count), "one text a reason");
  return r < Reason::count ? text[static_cast<unsigned>(r)] : "unknown";
}

SKINCTL_END_NAMESPACE
