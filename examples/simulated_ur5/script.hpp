// Uploaded text: cut into programs, and those recognised that do nothing but stream commands from one socket.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/geometry.hpp"
#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5 {

/// Cuts uploaded text into programs: a `def` or `sec` block up to its `end`, or a single line outside of
/// blocks.
class ScriptReader {
 public:
  static constexpr std::size_t longest_program = 256 * 1024;

  /// Takes text and appends the programs that it completes to `programs`. False: a program was longer than
  /// `longest_program`; the reader is then of no further use.
  bool feed(std::span<const std::uint8_t> bytes, std::vector<std::string>& programs);
  /// A block or a line is under way.
  bool unfinished() const { return !text_.empty(); }

 private:
  bool take_line(std::vector<std::string>& programs);

  std::string text_;      ///< of the block under way
  std::size_t line_ = 0;  ///< where the line under way begins
  int depth_ = 0;
};

/// A socket that a program opens.
struct SocketOpen {
  std::string host, name;
  std::uint16_t port = 0;
};

/// What was found in a program.
struct Program {
  std::string name;
  /// One socket from which the program reads 8 integers at a time and nothing else: the robot then obeys the reverse
  /// protocol as our own driver's program does, to the cycle. Empty for all others, which are interpreted.
  std::vector<SocketOpen> sockets;
  static constexpr std::size_t reverse = 0;  ///< which of them carries commands
  double servo_lookahead = 0.1;              ///< [s]; URScript's defaults where the program gives no number
  double servo_gain = 300;
  double speed_acceleration = 40;  ///< [rad/s^2]
  double stop_deceleration = 4;    ///< [rad/s^2]
  double multiplier = 1e6;         ///< integers per rad or rad/s
  bool streams() const { return !sockets.empty(); }

  std::optional<urscript::Watchdog> watchdog;
};

/// Recognises a program that streams. Linear in the text.
/// @param steptime  value of `get_steptime()` [s].
Program recognise(std::string_view text, double steptime);

}  // namespace simulated_ur5
