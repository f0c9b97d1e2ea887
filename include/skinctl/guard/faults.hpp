// SPDX-License-Identifier: BSD-3-Clause
// The table of faults: each reason that a cycle can report, with finder, reaction, way back and text.
#pragma once

#include <array>

#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The effect of a reason on the command.
enum class Reaction : unsigned char {
  none,    ///< no reaction: the fault cannot occur at the interface
  report,  ///< no reaction but the report
  refuse,  ///< the faulty input does not count; the cycle goes on with the last good one
  wait,    ///< plans and integrals are stopped; the laws go on
  hold,    ///< the last command is kept, or the refused motion is not begun
  limit,   ///< the command is cut to the allowed range and goes on
  fade,    ///< torques ramp to the fallback (gravity, friction); a force or a difference ramps to zero
  brake,   ///< the motion brakes with the acceleration limit, and holds
  stop     ///< brakes or fades, until the user's consent
};
inline constexpr std::size_t reaction_count = static_cast<std::size_t>(Reaction::stop) + 1;

/// The condition under which a reaction ends.
enum class WayBack : unsigned char {
  at_once,    ///< the reaction ends with the faulty cycle or sample
  by_itself,  ///< once the fault is over; the motion goes on from its present state, within its limits
  on_request  ///< once the fault is over and the user sends `CycleRequest::resume`
};
/// The stage that finds a fault, in the order of a cycle. Where several find it, the one whose reaction the
/// table lists.
enum class FaultFinder : unsigned char { loop, skin, law, skills, resolver, governor, guard };

/// A row of the table of faults.
struct Fault {
  Reason reason;
  const char* name;  ///< name of the enumerator
  FaultFinder finder;
  Reaction motion;  ///< reaction by position, velocity or impedance
  Reaction torque;  ///< reaction by torque
  WayBack way_back;
  const char* text;  ///< description for logs
};

/// A row for each reason, in the order of `Reason`. `describe`, the guard, the documentation and the tests
/// read this table.
inline constexpr std::array<Fault, static_cast<std::size_t>(Reason::count)> faults{{
    {Reason::state_not_finite, "state_not_finite", FaultFinder::guard, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "the joint state is NaN or infinite: the last good one stands"},
    {Reason::state_stale, "state_stale", FaultFinder::guard, Reaction::brake, Reaction::fade,
     WayBack::by_itself, "no good joint state for too long: brakes and holds"},
    {Reason::time_backwards, "time_backwards", FaultFinder::guard, Reaction::brake, Reaction::fade,
     WayBack::by_itself,
     "the clock went back or leapt absurdly: brakes and holds; of a sample: its stamp did not go on, "
     "refused"},
    {Reason::interval_too_long, "interval_too_long", FaultFinder::guard, Reaction::limit, Reaction::limit,
     WayBack::at_once, "the cycle came too late: the rest of the interval is dropped"},
    {Reason::interval_empty, "interval_empty", FaultFinder::guard, Reaction::hold, Reaction::hold,
     WayBack::at_once, "no time has passed: the command repeats"},
    {Reason::sample_not_finite, "sample_not_finite", FaultFinder::skin, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "a cell or sensor sent NaN or infinity: the sample is refused"},
    {Reason::sample_out_of_range, "sample_out_of_range", FaultFinder::skin, Reaction::refuse,
     Reaction::refuse, WayBack::at_once,
     "a sample is refused: a reading that its sensor cannot give, or a stamp ahead of the cycle's"},
    {Reason::sample_stale, "sample_stale", FaultFinder::skin, Reaction::fade, Reaction::fade,
     WayBack::by_itself,
     "a cell or sensor has been silent for too long, or its stamps are of another clock: its force fades"},
    {Reason::sample_unknown, "sample_unknown", FaultFinder::skin, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "a sample of a cell that no patch holds: refused"},
    {Reason::torque_not_finite, "torque_not_finite", FaultFinder::resolver, Reaction::refuse, Reaction::fade,
     WayBack::at_once, "a law gave NaN or infinity: its torque is not used"},
    {Reason::torque_limited, "torque_limited", FaultFinder::resolver, Reaction::limit, Reaction::limit,
     WayBack::at_once, "a torque, its rate or a power was cut to its limit"},
    {Reason::position_limited, "position_limited", FaultFinder::resolver, Reaction::limit, Reaction::limit,
     WayBack::at_once, "a joint was stopped before its position limit"},
    {Reason::velocity_limited, "velocity_limited", FaultFinder::resolver, Reaction::limit, Reaction::limit,
     WayBack::at_once, "the velocity of a joint was cut to its limit"},
    {Reason::acceleration_limited, "acceleration_limited", FaultFinder::resolver, Reaction::limit,
     Reaction::none, WayBack::at_once, "the acceleration of a joint was cut to its limit"},
    {Reason::step_limited, "step_limited", FaultFinder::guard, Reaction::brake, Reaction::limit,
     WayBack::by_itself,
     "no motion, or by torque no change of torque, within the limits leads to the command"},
    {Reason::command_not_finite, "command_not_finite", FaultFinder::guard, Reaction::brake, Reaction::fade,
     WayBack::by_itself, "the command is NaN, infinite, absurd or missing: brakes and holds"},
    {Reason::outside_limits, "outside_limits", FaultFinder::guard, Reaction::brake, Reaction::limit,
     WayBack::by_itself, "beyond a position limit, or too fast to stop before it: only motion inward"},
    {Reason::blocked, "blocked", FaultFinder::resolver, Reaction::hold, Reaction::none, WayBack::by_itself,
     "a joint is held fast: the command stays near it, and laws wait"},
    {Reason::displaced, "displaced", FaultFinder::resolver, Reaction::stop, Reaction::none,
     WayBack::on_request, "the robot moved away from its commands by more than the largest gap: holds"},
    {Reason::lead_limited, "lead_limited", FaultFinder::resolver, Reaction::limit, Reaction::none,
     WayBack::at_once, "the virtual robot was kept near the measured one"},
    {Reason::opposed, "opposed", FaultFinder::law, Reaction::wait, Reaction::wait, WayBack::by_itself,
     "skin and tracking push against each other: plan and integrals wait"},
    {Reason::goal_refused, "goal_refused", FaultFinder::law, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "a goal was refused (no number, no rotation, beyond limits): the old one stands"},
    {Reason::configuration_refused, "configuration_refused", FaultFinder::loop, Reaction::refuse,
     Reaction::refuse, WayBack::at_once, "no such configuration, or not now: the old one goes on"},
    {Reason::goal_stretched, "goal_stretched", FaultFinder::law, Reaction::limit, Reaction::limit,
     WayBack::at_once, "a goal got more time than asked, to keep limits of velocity or acceleration"},
    {Reason::bumpless_transfer, "bumpless_transfer", FaultFinder::law, Reaction::fade, Reaction::fade,
     WayBack::by_itself, "bumpless transfer: a difference of torque ramps to zero"},
    {Reason::singular, "singular", FaultFinder::resolver, Reaction::refuse, Reaction::none, WayBack::at_once,
     "a matrix could not be factorised: no acceleration in this sub-step"},
    {Reason::slowed, "slowed", FaultFinder::law, Reaction::limit, Reaction::limit, WayBack::by_itself,
     "near a singularity, or at the greatest joint speed: the tool moves slower"},
    {Reason::jerk_limited, "jerk_limited", FaultFinder::resolver, Reaction::limit, Reaction::none,
     WayBack::at_once, "the jerk of a joint was cut to its limit"},
    {Reason::jerk_exceeded, "jerk_exceeded", FaultFinder::governor, Reaction::report, Reaction::none,
     WayBack::at_once, "the jerk limit gave way to another limit"},
    {Reason::tool_speed_limited, "tool_speed_limited", FaultFinder::governor, Reaction::limit,
     Reaction::limit, WayBack::at_once, "all joints were slowed for the speed of the tool"},
    {Reason::clearance_kept, "clearance_kept", FaultFinder::governor, Reaction::limit, Reaction::limit,
     WayBack::at_once,
     "links come near each other or something around, or nothing is heard of it: slides along or brakes"},
    {Reason::state_out_of_range, "state_out_of_range", FaultFinder::guard, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "the joint state is one that this robot cannot have: the last good one stands"},
    {Reason::packets_lost, "packets_lost", FaultFinder::loop, Reaction::brake, Reaction::fade,
     WayBack::by_itself, "too many of the robot's packets never came: brakes and holds"},
    {Reason::contact_slowed, "contact_slowed", FaultFinder::governor, Reaction::limit, Reaction::limit,
     WayBack::by_itself, "all joints were slowed for somebody near or in touch"},
    {Reason::contact_force, "contact_force", FaultFinder::governor, Reaction::stop, Reaction::stop,
     WayBack::on_request, "a contact presses harder than its region bears: stops"},
    {Reason::contact_power, "contact_power", FaultFinder::governor, Reaction::stop, Reaction::stop,
     WayBack::on_request, "a contact takes more power than its region bears: stops"},
    {Reason::budget_overrun, "budget_overrun", FaultFinder::loop, Reaction::stop, Reaction::stop,
     WayBack::on_request, "cycle after cycle takes longer than its budget: stops"},
    {Reason::work_skipped, "work_skipped", FaultFinder::loop, Reaction::report, Reaction::report,
     WayBack::by_itself, "a cycle took longer than its budget: optional work is to be left out"},
    {Reason::consent_awaited, "consent_awaited", FaultFinder::guard, Reaction::stop, Reaction::stop,
     WayBack::on_request, "a fault that stops was seen: waits for the request to resume"},
    {Reason::skill_refused, "skill_refused", FaultFinder::skills, Reaction::refuse, Reaction::refuse,
     WayBack::at_once, "a skill may not start now: the old one goes on"},
    {Reason::skill_finished, "skill_finished", FaultFinder::skills, Reaction::report, Reaction::report,
     WayBack::by_itself, "the skill has done its work and holds"},
    {Reason::skill_failed, "skill_failed", FaultFinder::skills, Reaction::fade, Reaction::fade,
     WayBack::by_itself, "the skill failed: the one to fall back to takes over"},
    {Reason::tank_empty, "tank_empty", FaultFinder::resolver, Reaction::limit, Reaction::limit,
     WayBack::by_itself, "the energy tank cannot pay for the active torques: they are scaled down"},
    {Reason::energy_held, "energy_held", FaultFinder::resolver, Reaction::hold, Reaction::none,
     WayBack::by_itself, "to move on into a contact would cost more energy than it gave: held"},
    {Reason::stopping, "stopping", FaultFinder::resolver, Reaction::stop, Reaction::stop, WayBack::on_request,
     "a stop was asked for: brakes and holds; by torque with 0.2 of each limit, so that a person can still "
     "move the arm"},
    {Reason::skin_unheard, "skin_unheard", FaultFinder::skin, Reaction::report, Reaction::report,
     WayBack::by_itself, "the skin has not been heard yet: see its watch"},
    {Reason::skin_blind, "skin_blind", FaultFinder::skin, Reaction::report, Reaction::report,
     WayBack::by_itself, "no cell of a patch counts: see its watch"},
    {Reason::skin_incomplete, "skin_incomplete", FaultFinder::skin, Reaction::report, Reaction::report,
     WayBack::by_itself, "some cells do not report: see its watch"},
    {Reason::skin_slowed, "skin_slowed", FaultFinder::governor, Reaction::limit, Reaction::limit,
     WayBack::by_itself, "all joints are slowed, for a place that would lead and feels badly"},
    {Reason::skin_held, "skin_held", FaultFinder::governor, Reaction::brake, Reaction::fade,
     WayBack::by_itself, "brakes and holds until cells report again"},
    {Reason::skin_stopped, "skin_stopped", FaultFinder::governor, Reaction::stop, Reaction::stop,
     WayBack::on_request, "cells do not report: stops"},
    {Reason::start_refused, "start_refused", FaultFinder::guard, Reaction::stop, Reaction::stop,
     WayBack::on_request, "the robot does not stand where it was started: nothing is commanded"},
    {Reason::push_without_life, "push_without_life", FaultFinder::skin, Reaction::fade, Reaction::fade,
     WayBack::by_itself, "a push without life, as of a bias: what it reads counts as rest"},
    {Reason::interval_too_short, "interval_too_short", FaultFinder::resolver, Reaction::report,
     Reaction::report, WayBack::by_itself,
     "cycles last less than 1 % of the period: are stamps nanoseconds?"},
    {Reason::memory_refused, "memory_refused", FaultFinder::guard, Reaction::stop, Reaction::stop,
     WayBack::on_request, "the memory is of another scene, or of none: nothing is commanded"},
    {Reason::touch_unanswered, "touch_unanswered", FaultFinder::law, Reaction::report, Reaction::report,
     WayBack::by_itself, "the skin is touched, and no law or limit of the scene answers touch"},
}};
static_assert(
    [] {
      for (std::size_t i = 0; i < faults.size(); ++i)
        if (faults[i].reason != static_cast<Reason>(i) || faults[i].text == nullptr) return false;
      return true;
    }(),
    "faults: one row for each reason, in the order of the enumeration");

/// A reason in words, for logs.
[[nodiscard]] constexpr const char* describe(Reason r) noexcept {
  return r < Reason::count ? faults[static_cast<std::size_t>(r)].text : "unknown";
}
/// The name of a reason's enumerator.
[[nodiscard]] constexpr const char* name(Reason r) noexcept {
  return r < Reason::count ? faults[static_cast<std::size_t>(r)].name : "unknown";
}

/// The reasons of the table for which `test(fault)` holds.
template <class Test>
[[nodiscard]] constexpr Status reasons_of(Test&& test) noexcept {
  Status out;
  for (const Fault& f : faults)
    if (test(f)) out |= f.reason;
  return out;
}

namespace detail {
/// Reasons with which a cycle has no new state of the robot.
inline constexpr Status no_new_state = Status(Reason::state_not_finite) | Reason::state_out_of_range |
                                       Reason::state_stale | Reason::time_backwards | Reason::interval_empty;
/// Whether the guard carries out the reaction to a fault of another stage. The other stages carry out theirs
/// themselves, and report it.
constexpr bool is_left_to_guard(const Fault& f) noexcept {
  return f.finder == FaultFinder::loop || f.finder == FaultFinder::governor;
}
/// Reasons of other stages on which the guard brakes.
inline constexpr Status guard_brakes_on = reasons_of([](const Fault& f) {
  return is_left_to_guard(f) && (f.motion == Reaction::brake || f.motion == Reaction::stop);
});
/// Reasons of other stages after which the guard waits for consent.
inline constexpr Status guard_waits_after =
    reasons_of([](const Fault& f) { return is_left_to_guard(f) && f.way_back == WayBack::on_request; });
}  // namespace detail

constexpr const char* name(Reaction r) noexcept {
  constexpr const char* text[] = {"-", "report", "refuse", "wait", "hold", "limit", "fade", "brake", "stop"};
  static_assert(sizeof text / sizeof *text == reaction_count);
  return r <= Reaction::stop ? text[static_cast<unsigned>(r)] : "unknown";
}
constexpr const char* name(WayBack w) noexcept {
  constexpr const char* text[] = {"at once", "by itself", "on request"};
  return w <= WayBack::on_request ? text[static_cast<unsigned>(w)] : "unknown";
}
constexpr const char* name(FaultFinder f) noexcept {
  constexpr const char* text[] = {"loop", "skin", "law", "skills", "resolver", "governor", "guard"};
  return f <= FaultFinder::guard ? text[static_cast<unsigned>(f)] : "unknown";
}

SKINCTL_END_NAMESPACE
