// What a gripper's controller answers, byte for byte; time is told to it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "examples/adapters/gripper/modbus.hpp"
#include "examples/simulated_gripper/fingers.hpp"

namespace simulated_gripper {

/// The lines of a Robotiq 2F-85, as its driver on port 63352 speaks them.
class RobotiqDevice {
 public:
  explicit RobotiqDevice(bool active = false) {
    variables_["STA"] = active ? 3 : 0, variables_["ACT"] = active;
  }
  /// Moves the fingers to `now` [s], then answers one line.
  std::string answer(std::string_view line, double now);
  Fingers& fingers() { return fingers_; }
  /// FLT from now on; 0: none.
  void fault(int code) { variables_["FLT"] = code; }
  static constexpr double opening = 0.085, activation = 0.5;  ///< [m], [s]

 private:
  void advance(double now);
  void set(std::string_view words);

  Fingers fingers_{opening};
  std::map<std::string, int, std::less<>> variables_{{"ACT", 0}, {"GTO", 0}, {"ATR", 0}, {"ADR", 0},
                                                     {"FOR", 0}, {"SPE", 0}, {"POS", 0}, {"STA", 0},
                                                     {"PRE", 0}, {"OBJ", 3}, {"FLT", 0}};
  double now_ = 0, active_at_ = 0;
  bool started_ = false;
};

/// The registers of an OnRobot RG2 at unit 65.
class OnRobotDevice {
 public:
  /// Moves the fingers to `now` [s], then answers a frame.
  adapters::gripper::modbus::Bytes answer(const adapters::gripper::modbus::Frame& frame, double now);
  Fingers& fingers() { return fingers_; }
  /// A bit of the status from now on, 2 to 6: its safety switches.
  void safety(std::uint16_t bits) { safety_ = bits; }
  /// How far each fingertip reaches inward of its finger from now on [0.1 mm].
  void fingertips(std::int16_t offset) { offset_ = offset; }
  static constexpr double opening = 0.11, speed = 0.1;  ///< [m], [m/s]

 private:
  void advance(double now);
  void write(std::uint16_t at, std::uint16_t value);
  [[nodiscard]] int value_at(std::uint16_t at) const;

  Fingers fingers_{opening};
  std::int16_t offset_ = 0;
  std::uint16_t force_ = 400, width_ = 1100, safety_ = 0;
  double now_ = 0;
  bool started_ = false;
};

/// A Lacquey behind a thread of the robot's program: words, no answers, deaf for a second after each motion's
/// word.
class LacqueyDevice {
 public:
  /// Moves the fingers to `now` [s], then hears a word.
  void hear(std::int32_t word, double now);
  Fingers& fingers() { return fingers_; }
  static constexpr double opening = 0.08, force = 20, speed = 0.1, busy = 1;  ///< [m], [N], [m/s], [s]

 private:
  Fingers fingers_{opening};
  double now_ = 0, deaf_until_ = 0;
  bool started_ = false, active_ = false;
};

}  // namespace simulated_gripper
