// A log of commands and measurements as a file.
#pragma once

#include <string>

#include "skinctl/calibration/robot_response_types.hpp"

namespace identify_robot {

using Log = skinctl::ResponseLog<6>;

/// Reads lines `sent,TIME,Q0,...,Q5` and `measured,TIME,Q0,...,Q5`, times in seconds, angles in radians;
/// lines that begin with `#` are comments. Throws `skinctl::ConfigurationError` with file and line for
/// anything else.
[[nodiscard]] Log read_log(const std::string& file);
/// Throws `skinctl::ConfigurationError` if the file cannot be written.
void write_log(const std::string& file, const Log& log);

}  // namespace identify_robot
