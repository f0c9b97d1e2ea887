// What the primary and secondary ports send: version, robot state, messages.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::primary {

/// How a message of the controller ranks: the report levels of error codes.
enum class ReportLevel : std::int32_t { debug = 0, info = 1, warning = 2, violation = 3, fault = 4 };

/// The version message that a client gets first.
void write_version(std::vector<std::uint8_t>& out, const Version& version, Nanoseconds now);

/// A robot state message. `first`: with kinematics and configuration, which a client gets once.
void write_state(std::vector<std::uint8_t>& out, const RobotState& state, Nanoseconds now, Series series,
                 bool first);

// Messages for primary clients; texts are cut at 1024 characters.
void write_text(std::vector<std::uint8_t>& out, std::string_view text, Nanoseconds now);
/// Code and argument as in "C<code>A<argument>".
void write_error(std::vector<std::uint8_t>& out, std::int32_t code, std::int32_t argument, ReportLevel level,
                 std::string_view text, Nanoseconds now);
/// Of every change of the safety mode.
void write_safety_mode(std::vector<std::uint8_t>& out, SafetyMode mode, Nanoseconds now);
/// Events with a title, such as PROGRAM_XXX_STARTED with the program's name.
void write_key(std::vector<std::uint8_t>& out, std::string_view title, std::string_view text,
               Nanoseconds now);
/// A program ended by an error at `line` and `column`, counted from 1.
void write_exception(std::vector<std::uint8_t>& out, std::int32_t line, std::int32_t column,
                     std::string_view text, Nanoseconds now);
void write_popup(std::vector<std::uint8_t>& out, std::string_view title, std::string_view text, bool warning,
                 bool error, bool blocking, Nanoseconds now);

}  // namespace simulated_ur5::primary
