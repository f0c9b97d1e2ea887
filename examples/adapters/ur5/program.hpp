// The URScript program that moves the arm, and the messages that it reads.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "examples/adapters/ur5/version.hpp"
#include "skinctl/core/command.hpp"

namespace adapters::ur5 {

/// Modes of the reverse socket's messages.
namespace mode {
inline constexpr std::int32_t stopped = -2, idle = 0, servoj = 1, speedj = 2, torque = 8;
}

/// `lookahead_time` of the program's servoj, the least there is [s]: by position the arm comes behind its
/// commands by a lag of that beside the drive's own, by velocity it does not.
inline constexpr double servoj_lookahead = 0.03;

/// What the controller compensates under direct torque, beside gravity.
struct TorqueSettings {
  bool friction = true;  ///< false: none
  /// Shares of the controller's own model of friction, 0 to 1; only where the version takes them. Dry
  /// friction it compensates by the measured speed: not at rest, and at once when a joint slips, so that a
  /// law that learns friction (`FrictionLearning`) hunts beside it: give it `coulomb` 0.
  std::array<double, 6> viscous{0.9, 0.9, 0.8, 0.9, 0.9, 0.9}, coulomb{0.8, 0.8, 0.7, 0.8, 0.8, 0.8};
};

struct ProgramSettings {
  std::string address;     ///< of this computer
  std::uint16_t port = 0;  ///< likewise
  double rate = 125;       ///< of the controller's cycle [1/s]
  skinctl::Interface interface = skinctl::Interface::position;
  Version version{};  ///< of the controller: decides on the form of direct_torque
  TorqueSettings torque{};
  bool echo = false;  ///< the program counts its messages in output register `echo_register`
};
inline constexpr int echo_register = 24;  ///< an integer, of those that no field bus uses
inline constexpr std::int32_t echo_numbers =
    512 * 2000;  ///< after the last of them the count begins anew with 1

/// The text. It connects to `address:port`, obeys each message for at most the time in it, and then stops the
/// arm with `stopj`, whatever has become of this computer.
[[nodiscard]] std::string program(const ProgramSettings& settings);

/// A message of the reverse socket: read timeout [ms], six numbers in millionths, mode.
[[nodiscard]] std::array<std::uint8_t, 32> message(std::int32_t timeout_ms,
                                                   const std::array<double, 6>& values,
                                                   std::int32_t mode) noexcept;

}  // namespace adapters::ur5
