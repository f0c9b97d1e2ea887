// What a run has shown, and how it ended, in words.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "examples/compliant_ur5/connection.hpp"
#include "examples/compliant_ur5/endings.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "skinctl/hardware/loop.hpp"

namespace compliant_ur5 {

/// Why a run ends.
struct Found {
  Ending ending = Ending::finished;
  std::string detail;  ///< words beside those of the ending's row
};

/// Largest values of a run, in units of their limits.
struct Largest {
  double velocity = 0;      ///< of the commands; by torque of the joints
  double acceleration = 0;  ///< of the commands
  double torque = 0;        ///< of the commands
};

/// A run in figures.
struct RunFigures {
  skinctl::LoopEnd ended = skinctl::LoopEnd::finished;
  std::uint64_t cycles = 0, samples = 0, missed = 0, silent = 0;
  std::uint64_t allocations = 0;  ///< in the loop
  Largest largest;
  std::optional<double> lag;  ///< beyond the declared one [s]; none: not known
  double load = 0;            ///< longest time from a state to its command [s]
  double behind = 0;          ///< farthest that the simulated robot was behind the clock [s of its time]
};

/// The touches of a run, with what the simulated fingers felt, and the largest force. Stops the simulated
/// robot. Returns `RunFigures::behind`.
double tell_touches(const TouchObserver& observer, Connection& connection, bool places_known, RunLog& log);

/// Title and figures of a run.
void tell_figures(const Settings& settings, const RunFigures& figures, const adapters::ur5::Driver& driver,
                  RunLog& log);

/// What the skin's receiver has found.
/// @param cells  how many of them report, in words.
void tell_skin(const adapters::skin::Receiver& receiver, const std::string& cells, RunLog& log);

/// The run is over: its ending, in words, to `log` and to the standard error. A broken promise makes an end
/// that would be fine `Ending::broken`.
Outcome tell_end(const Settings& settings, Found found, const RunFigures& figures,
                 const adapters::ur5::Driver& driver, RunLog& log);

/// Nothing has moved.
Outcome not_tared(const char* why, RunLog& log);

}  // namespace compliant_ur5
