// Why a robot that is the clock was lost: one table for driver, programs and pages.
#pragma once

#include <array>

#include "examples/support/job.hpp"

namespace adapters {

/// Reasons of a `ClockedDriver`.
enum class ClockFault : unsigned char {
  none,
  unreachable,  ///< no datagram at the start
  silent,       ///< no datagram any more
  late,         ///< answers that the controller counts as late
  sequence,     ///< numbers of cycles that go back, or leap
  joints,       ///< datagrams with another number of joints
  declared,     ///< a controller that is set otherwise than this program was told
  nonsense,     ///< datagrams that are none of the protocol
  stopped,      ///< a robot that says itself that it takes no more motion
  limit,        ///< a command beyond what the controller was set to take
  socket,       ///< the socket of this computer
  count
};

struct ClockFaultRow {
  ClockFault fault;
  const char* name;  ///< as the enumerator
  examples::job::Exit exit;
  const char* words;     ///< for logs
  const char* way_back;  ///< for the user
};

inline constexpr std::array<ClockFaultRow, static_cast<std::size_t>(ClockFault::count)> clock_faults{{
    {ClockFault::none, "none", examples::job::Exit::fine, "nothing", "-"},
    {ClockFault::unreachable, "unreachable", examples::job::Exit::lost, "no datagram from the controller",
     "does its program run, does it send to this address and port, does a firewall close the port?"},
    {ClockFault::silent, "silent", examples::job::Exit::lost, "the controller has fallen silent",
     "see its panel and the cable; start its program, then this one"},
    {ClockFault::late, "late", examples::job::Exit::lost, "the controller counts answers as late",
     "a network of its own, a real-time kernel, a longer cycle; start again"},
    {ClockFault::sequence, "sequence", examples::job::Exit::implausible,
     "the controller's numbers of cycles went back or leapt", "was its program started anew? start again"},
    {ClockFault::joints, "joints", examples::job::Exit::refused,
     "another number of joints than its protocol has", "send all axes: see the page"},
    {ClockFault::declared, "declared", examples::job::Exit::refused,
     "the controller is set otherwise than declared", "change its program, or what this one is told"},
    {ClockFault::nonsense, "nonsense", examples::job::Exit::lost, "datagrams that are none of this protocol",
     "see protocol, version and port; start again"},
    {ClockFault::stopped, "stopped", examples::job::Exit::halted, "the robot takes no more motion",
     "clear it at the panel; start again"},
    {ClockFault::limit, "limit", examples::job::Exit::broken, "a command beyond what the controller takes",
     "state its limits to this program"},
    {ClockFault::socket, "socket", examples::job::Exit::lost, "this computer's socket is broken",
     "start again"},
}};
static_assert(
    [] {
      for (std::size_t k = 0; k < clock_faults.size(); ++k)
        if (clock_faults[k].fault != static_cast<ClockFault>(k)) return false;
      return true;
    }(),
    "clock_faults: one row for each, in the order of the enumeration");

[[nodiscard]] constexpr const ClockFaultRow& row(ClockFault fault) noexcept {
  return clock_faults[fault < ClockFault::count ? static_cast<std::size_t>(fault) : 0];
}

}  // namespace adapters
