// The report of a calibration: one page with its pictures in it.
#pragma once

#include <string>

#include "examples/calibrate_skin/steps.hpp"

namespace calibrate_skin {

/// HTML of the results in a folder. Only steps that have been done appear.
[[nodiscard]] std::string report_of(const fs::path& folder);

}  // namespace calibrate_skin
