// What the primary and secondary ports send: version, robot state, texts.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::primary {

/// The version message that a client gets first.
void write_version(std::vector<std::uint8_t>& out, const Version& version, Nanoseconds now);
/// A robot state message with robot mode and joint data.
void write_state(std::vector<std::uint8_t>& out, const RobotState& state, Nanoseconds now);
/// A text message, for primary clients.
void write_text(std::vector<std::uint8_t>& out, std::string_view text, Nanoseconds now);

}  // namespace simulated_ur5::primary
