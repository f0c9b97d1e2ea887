// URScript as far as the simulated controller understands it: streams over a socket, and straight-line
// scripts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/geometry.hpp"

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

/// What one statement of a straight-line script does.
struct Statement {
  enum class Kind {
    stop,            ///< stopj(number)
    move,            ///< movej(joints, a, v, t)
    speed,           ///< speedj(joints, a, t)
    digital_output,  ///< bit `index` of all outputs becomes `flag`
    sleep,           ///< number seconds
    text,            ///< textmsg
    popup,
    integer_register,  ///< output register `index` becomes number
    double_register,
    bit_register,
    halt
  };
  Kind kind = Kind::halt;
  Joints joints{};
  double number = 0;  ///< deceleration, seconds or value
  double acceleration = 0, velocity = 0, duration = 0;
  std::size_t index = 0;
  bool flag = false;
  std::string text;
};

/// A socket that a program opens.
struct SocketOpen {
  std::string host, name;
  std::uint16_t port = 0;
};

/// What was understood of a program.
struct Program {
  std::string name;
  bool secondary = false;  ///< `sec`: runs beside the main program and must not move the robot

  /// A program that opens sockets and reads 8 integers at a time from one of them: the robot then obeys the
  /// reverse protocol. Empty for a straight-line script.
  std::vector<SocketOpen> sockets;
  std::size_t reverse = 0;       ///< which of them carries commands
  double servo_lookahead = 0.1;  ///< [s]; URScript's defaults where the program gives no number
  double servo_gain = 300;
  double speed_acceleration = 40;  ///< [rad/s^2]
  double stop_deceleration = 4;    ///< [rad/s^2]
  double multiplier = 1e6;         ///< integers per rad or rad/s
  bool streams() const { return !sockets.empty(); }

  /// rtde_set_watchdog(variable, min_frequency, action).
  struct Watchdog {
    std::string variable;
    double min_frequency = 10;
    bool stops = false;  ///< else pauses
  };
  std::optional<Watchdog> watchdog;

  std::vector<Statement> statements;
  std::vector<std::string> warnings;  ///< what was not understood and is skipped
  std::string error;                  ///< not empty: the program cannot run
};

/// Recognises a program.
/// @param steptime  value of `get_steptime()` [s].
Program recognise(std::string_view text, double steptime);

}  // namespace simulated_ur5
