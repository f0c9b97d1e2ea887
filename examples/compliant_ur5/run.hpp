// One run of the main job: connect, take over, give way, stop.
#pragma once

#include <atomic>

#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"

namespace compliant_ur5 {

/// How a run ended; also the exit code of the program.
enum class Outcome : int {
  fine = 0,
  lost = 1,     ///< the robot went away, or robot or skin talked nonsense: the robot was told to stop
  refused = 2,  ///< a setting or file is wrong
  broken = 3,   ///< a promise was broken: a command beyond its limits, an allocation in the loop, a replay
                ///< that differs
  blind = 4,    ///< too few cells of the skin reported, or none: the robot was told to stop
  interrupted = 130
};

/// Runs against the robot of the settings, or against a simulated one that it starts in this process. Prints
/// a progress line and what it found, unless quiet.
Outcome run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log);

/// Replays a recording through the same scene and says whether every command is the same.
Outcome replay(const Settings& settings);

}  // namespace compliant_ur5
