// What was found about a robot, in words and as a file.
#pragma once

#include <string>

#include "examples/identify_robot/log_file.hpp"

namespace identify_robot {

using Response = skinctl::RobotResponse<6>;

/// See `skinctl::identify_response`; a UR5's gravity shows the stiffness of its servos.
[[nodiscard]] Response identify(const Log& log);
/// Why none of its numbers may be used: units that are no seconds and radians, a delay or lag whose deviation
/// is larger than what a controller can bear. Empty if they can be used.
[[nodiscard]] std::string why_unusable(const Response& found);
/// A table for people, with what to do about it.
[[nodiscard]] std::string in_words(const Response& found);
/// A TOML file: `[control]` with delay and lag, as the scenario of `compliant_ur5` has them, and
/// `[robot_found]` with all numbers and their deviations.
[[nodiscard]] std::string as_toml(const Response& found);

}  // namespace identify_robot
