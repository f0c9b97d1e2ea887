// Why a UR is lost to its program: one table of what is seen, what happens, how long until rest, and the way
// back.
#pragma once

#include <array>
#include <string_view>

#include "examples/support/exit.hpp"

namespace adapters::ur5 {

/// What ends the connection with a robot.
enum class Fault : unsigned char {
  none,
  unreachable,       ///< before the loop: nobody answers, or the robot cannot do what is asked
  stream_closed,     ///< the controller was restarted, or its process has died
  silent,            ///< a cable is out, or a connection is half open
  nonsense,          ///< no packages of the protocol, or of its version
  commands_refused,  ///< the reverse socket is closed or does not take commands
  paused,
  program_ended,
  slider_at_zero,
  protective_stop,
  safety_stop,
  not_running,
  clock_stands,
  clock_runs_wrong,
  not_a_number,
  count
};

/// A row of the table. `rest_ms` counts from the fault until all joints stand, of an arm that is told no more
/// than 3 rad/s: what the robot does by itself is part of it.
struct FaultRow {
  Fault fault;
  const char* name;      ///< as the enumerator
  const char* seen;      ///< by what
  const char* reaction;  ///< of robot and program
  int rest_ms;           ///< 0: nothing has moved
  examples::job::Exit exit;
  const char* words;     ///< what has happened, for logs
  const char* way_back;  ///< what the user does
};

inline constexpr std::array<FaultRow, static_cast<std::size_t>(Fault::count)> faults{{
    {Fault::none, "none", "-", "-", 0, examples::job::Exit::fine, "nothing", "-"},
    {Fault::unreachable, "unreachable", "no answer, or a refusal, while connecting", "nothing is moved", 0,
     examples::job::Exit::lost, "the robot cannot be reached or cannot do what is asked",
     "see the words; start again"},
    {Fault::stream_closed, "stream_closed", "end of the RTDE stream", "the robot's program stops it (stopj)",
     1000, examples::job::Exit::lost, "the robot closed the RTDE connection",
     "connect() again, or start again"},
    {Fault::silent, "silent", "no state for 500 ms",
     "from 40 ms on (by torque 20) it is told to hold; then the robot's program stops it", 1200,
     examples::job::Exit::lost, "no state from the robot", "mend the cable; connect() again, or start again"},
    {Fault::nonsense, "nonsense",
     "a size that no package has, or only packages that cannot be read for 500 ms",
     "the robot's program stops it", 1200, examples::job::Exit::lost, "nonsense on the robot's RTDE stream",
     "start again"},
    {Fault::commands_refused, "commands_refused", "the reverse socket is closed, or is full for 20 ms",
     "the robot's program stops it", 1000, examples::job::Exit::lost, "the program on the robot hung up",
     "start again"},
    {Fault::paused, "paused", "runtime_state 3 or 4",
     "the controller brakes (4 rad/s^2); its program is ended", 1000, examples::job::Exit::halted,
     "the program on the robot was paused", "start again; 'play' does not continue it"},
    {Fault::program_ended, "program_ended", "runtime_state 0 or 1", "the controller brakes (4 rad/s^2)", 1000,
     examples::job::Exit::halted,
     "the program on the robot has ended: stopped at the panel, replaced, or commands did not arrive",
     "start again"},
    {Fault::slider_at_zero, "slider_at_zero", "speed scaling below 1 % for 100 ms",
     "the controller holds; its program is ended", 1100, examples::job::Exit::halted,
     "the speed slider stands at 0 %", "move the slider up; start again"},
    {Fault::protective_stop, "protective_stop", "safety_mode 3", "the controller stops; nothing is unlocked",
     500, examples::job::Exit::halted, "protective stop",
     "find the cause; unlock at the panel, or --unlock; start again"},
    {Fault::safety_stop, "safety_stop", "safety_mode 4 to 9", "the controller stops", 500,
     examples::job::Exit::halted, "a safety function stopped the robot",
     "clear it at the panel; start again"},
    {Fault::not_running, "not_running", "robot_mode other than 7", "power is off: brakes", 500,
     examples::job::Exit::halted, "the robot stopped running", "power on; start again"},
    {Fault::clock_stands, "clock_stands", "packages whose time stamp is not later, for 500 ms",
     "from 40 ms on (by torque 20) it is told to hold; then the robot's program stops it", 1200,
     examples::job::Exit::implausible, "the robot's clock stands still or went back",
     "restart the controller; start again"},
    {Fault::clock_runs_wrong, "clock_runs_wrong",
     "less than half or more than twice this computer's time, for 0.75 s", "the robot is told to stop", 1500,
     examples::job::Exit::implausible, "the robot's clock does not agree with this computer's",
     "restart the controller; start again"},
    {Fault::not_a_number, "not_a_number", "states that are not finite for 100 ms",
     "single ones are skipped; then the robot is told to stop", 1000, examples::job::Exit::implausible,
     "the robot reports joints that are no numbers", "restart the controller; start again"},
}};
static_assert(
    [] {
      for (std::size_t k = 0; k < faults.size(); ++k)
        if (faults[k].fault != static_cast<Fault>(k) || faults[k].name == nullptr) return false;
      return true;
    }(),
    "faults: one row for each, in the order of the enumeration");

[[nodiscard]] constexpr const FaultRow& row(Fault fault) noexcept {
  return faults[fault < Fault::count ? static_cast<std::size_t>(fault) : 0];
}

}  // namespace adapters::ur5
