// The report of a run: a page with pictures and a timeline, and the figures in words.
#pragma once

#include <string>

#include "examples/packing_oranges/run.hpp"

namespace packing {

/// The figures, one a line.
std::string summary(const Outcome& outcome, const RunSettings& settings);
/// The page: no script, nothing beside it.
std::string report(const Outcome& outcome, const RunSettings& settings);

}  // namespace packing
