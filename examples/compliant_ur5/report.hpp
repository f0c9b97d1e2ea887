// What a run did, for people: one HTML file that needs nothing else, and one picture.
#pragma once

#include <string>

#include "examples/compliant_ur5/run_log.hpp"

namespace compliant_ur5 {

/// The run in one sentence.
std::string headline(const RunLog& log);

/// A self-contained HTML page: what happened, every touch, plots, cycle times, scenario. No script, no
/// network; readable from 320 px on, light and dark. Numbers that are not finite appear as dashes and gaps.
std::string report(const RunLog& log);

/// Writes `report(log)`; the file is complete or, when it cannot be written, absent and `std::runtime_error`
/// says why.
void write_report(const RunLog& log, const std::string& path);

/// Force above, deflection below, as one SVG file.
std::string picture(const RunLog& log);

}  // namespace compliant_ur5
