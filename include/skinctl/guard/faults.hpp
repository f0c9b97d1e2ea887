// What can go wrong, what is done about it, and what it takes to go on: one table.
#pragma once

#include <array>

#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What a fault makes of the command.
enum class Reaction : unsigned char {
  none,    ///< cannot occur at this interface
  refuse,  ///< what is wrong does not count; the cycle goes on with what it had
  hold,    ///< the last command stands
  limit,   ///< the command is cut to what is allowed and goes on
  fade,    ///< torques ramp to the fallback (gravity held, friction); a cell's force ramps to zero
  brake,   ///< the motion brakes with the acceleration limit, and holds
  stop     ///< brakes or fades, and stays so
};
/// When the reaction ends.
enum class WayBack : unsigned char {
  at_once,    ///< it lasts for the cycle, or the sample, that is wrong
  by_itself,  ///< once what was wrong is over; the motion goes on from where it is, within its limits
  on_request  ///< once it is over and the user says `CycleRequest::resume`
};
/// Who finds out.
enum class FaultFinder : unsigned char { guard, skin, resolver, governor, loop };

struct Fault {
  Reason reason;
  FaultFinder finder;
  Reaction motion;  ///< position and velocity interfaces
  Reaction torque;  ///< torque interface
  WayBack way_back;
  const char* what;
};

/// Every fault, its reaction and its way back. Guard, documentation and tests read this table.
inline constexpr std::array<Fault, 20> faults{{
    {Reason::command_not_finite, FaultFinder::guard, Reaction::brake, Reaction::fade, WayBack::by_itself,
     "a command that is NaN, infinite, absurd, or none"},
    {Reason::step_limited, FaultFinder::guard, Reaction::brake, Reaction::limit, WayBack::by_itself,
     "a command that no motion within the limits reaches"},
    {Reason::outside_limits, FaultFinder::guard, Reaction::brake, Reaction::none, WayBack::by_itself,
     "a command beyond an end, or too fast to stop before it"},
    {Reason::torque_limited, FaultFinder::resolver, Reaction::limit, Reaction::limit, WayBack::at_once,
     "a torque or power beyond its limit"},
    {Reason::state_not_finite, FaultFinder::guard, Reaction::refuse, Reaction::refuse, WayBack::at_once,
     "a joint state that is NaN or infinite"},
    {Reason::state_out_of_range, FaultFinder::guard, Reaction::refuse, Reaction::refuse, WayBack::at_once,
     "a joint state that this robot cannot have"},
    {Reason::state_stale, FaultFinder::guard, Reaction::brake, Reaction::fade, WayBack::by_itself,
     "no good joint state for too long"},
    {Reason::time_backwards, FaultFinder::guard, Reaction::brake, Reaction::fade, WayBack::by_itself,
     "the clock goes back or leaps absurdly"},
    {Reason::interval_empty, FaultFinder::guard, Reaction::hold, Reaction::hold, WayBack::at_once,
     "the clock stands still"},
    {Reason::interval_too_long, FaultFinder::guard, Reaction::limit, Reaction::limit, WayBack::at_once,
     "a cycle comes too late: no step takes credit for the pause"},
    {Reason::packets_lost, FaultFinder::loop, Reaction::brake, Reaction::fade, WayBack::by_itself,
     "too many of the robot's packets never came"},
    {Reason::budget_overrun, FaultFinder::loop, Reaction::stop, Reaction::stop, WayBack::on_request,
     "cycle after cycle takes longer than its budget"},
    {Reason::sample_not_finite, FaultFinder::skin, Reaction::refuse, Reaction::refuse, WayBack::at_once,
     "a cell sends NaN or infinity"},
    {Reason::sample_out_of_range, FaultFinder::skin, Reaction::refuse, Reaction::refuse, WayBack::at_once,
     "a cell sends what its sensor cannot give"},
    {Reason::sample_unknown, FaultFinder::skin, Reaction::refuse, Reaction::refuse, WayBack::at_once,
     "a sample of a cell that is not there"},
    {Reason::sample_stale, FaultFinder::skin, Reaction::fade, Reaction::fade, WayBack::by_itself,
     "a cell has been silent for too long: it stops to push"},
    {Reason::torque_not_finite, FaultFinder::resolver, Reaction::refuse, Reaction::fade, WayBack::at_once,
     "a law gives NaN or infinity"},
    {Reason::contact_slowed, FaultFinder::governor, Reaction::limit, Reaction::limit, WayBack::by_itself,
     "somebody is near or in touch"},
    {Reason::contact_force, FaultFinder::governor, Reaction::stop, Reaction::stop, WayBack::on_request,
     "a contact presses harder than its region bears"},
    {Reason::contact_power, FaultFinder::governor, Reaction::stop, Reaction::stop, WayBack::on_request,
     "a contact takes more power than its region bears"},
}};

/// The reasons of the table for which `test(fault)` holds.
template <class Test>
[[nodiscard]] constexpr Status reasons_of(Test&& test) noexcept {
  Status out;
  for (const Fault& f : faults)
    if (test(f)) out |= f.reason;
  return out;
}

constexpr const char* name(Reaction r) noexcept {
  constexpr const char* text[] = {"-", "refuse", "hold", "limit", "fade", "brake", "stop"};
  return r <= Reaction::stop ? text[static_cast<unsigned>(r)] : "unknown";
}
constexpr const char* name(WayBack w) noexcept {
  constexpr const char* text[] = {"at once", "by itself", "on request"};
  return w <= WayBack::on_request ? text[static_cast<unsigned>(w)] : "unknown";
}
constexpr const char* name(FaultFinder f) noexcept {
  constexpr const char* text[] = {"guard", "skin", "resolver", "governor", "loop"};
  return f <= FaultFinder::loop ? text[static_cast<unsigned>(f)] : "unknown";
}

SKINCTL_END_NAMESPACE
