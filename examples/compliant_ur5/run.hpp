// One run of the main job: connect, take over, give way, stop.
#pragma once

#include <atomic>

#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "examples/support/job.hpp"

namespace compliant_ur5 {

/// How a run ended; also the exit code of the program: see endings.hpp.
using Outcome = examples::job::Exit;

/// Runs against the robot of the settings, or against a simulated one that it starts in this process. Prints
/// a progress line and what it found, unless quiet.
Outcome run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log);

/// Replays a recording through the same scene and says whether every command is the same.
Outcome replay(const Settings& settings);

}  // namespace compliant_ur5
