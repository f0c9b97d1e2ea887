// Franka's FR3 by joint impedance: the Franka Control Interface as a robot that is the clock.
#pragma once

#include <string>

#include "examples/adapters/franka/messages.hpp"
#include "examples/adapters/robot_clock.hpp"
#include "examples/adapters/socket.hpp"

namespace adapters::franka {

struct Options {
  std::string host = "127.0.0.1";     ///< address of the robot's control unit, IPv4
  std::uint16_t port = default_port;  ///< another one only of a simulation
  double stiffness = 500;             ///< of each joint's spring, set at the start [N m/rad]
  double collision_torque = 60;       ///< torque of the world at a joint that ends the motion [N m]
  double collision_force = 100;       ///< force of the world at the flange that ends it [N]
  bool recover = false;               ///< clears the errors that ended a motion before, as a person allows
};

/// A `ClockProtocol`. Sets springs and thresholds, and begins a motion by positions.
class Franka {
 public:
  static constexpr std::size_t joints = franka::joints;
  static constexpr bool answers_every_number = false;  // the robot goes on by itself in cycles without one
  static constexpr bool finds_torque = true;

  /// Throws `ConfigurationError`.
  explicit Franka(const Options& options);
  /// Throws `ConnectionError`, and `ConfigurationError` for another version.
  void open(can::Deadline deadline);
  /// Says that the motion has ended until the robot agrees, or stops it.
  void close(can::Deadline deadline) noexcept;
  [[nodiscard]] UdpSocket& socket() noexcept { return socket_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return skinctl::Nanoseconds(1'000'000); }
  ClockFault read(std::span<const std::uint8_t> bytes, ClockedStateOf<joints>& state) noexcept;
  std::size_t answer(std::uint64_t number, const SevenJoints& q, bool last,
                     std::span<std::uint8_t> out) noexcept;
  /// The robot takes no torque beside positions: its own controller adds what it finds right.
  void beside(const SevenJoints&) noexcept {}
  [[nodiscard]] const char* refuses(const SevenJoints&) const noexcept { return nullptr; }
  [[nodiscard]] const char* why() const noexcept { return why_; }
  [[nodiscard]] std::string place() const { return options_.host + ":" + std::to_string(options_.port); }

 private:
  std::uint8_t ask(Function function, std::span<const std::uint8_t> payload, can::Deadline deadline);
  void set(Function function, std::span<const double> numbers, const char* what, can::Deadline deadline);
  std::uint8_t answer_to(std::uint32_t number, Function function, can::Deadline deadline);
  ClockFault ended(const State& s) noexcept;
  [[nodiscard]] SevenJoints towards(std::uint64_t number, const SevenJoints& q) noexcept;

  Options options_;
  std::unique_ptr<Stream> stream_;  ///< moves with the protocol
  UdpSocket socket_;
  Inbox inbox_;
  std::uint32_t requests_ = 0;
  std::uint16_t other_version_ = 0;
  State newest_;
  std::uint64_t answered_ = 0;  ///< number of the state that the last answer was for; 0: none
  std::uint32_t late_ = 0;
  double success_ = 1;
  /// The plan of the last answer, and how many cycles before it had one each, without a gap.
  SevenJoints plan_{}, plan_dq_{};
  int in_a_row_ = 0;
  bool moves_ = false;  ///< the robot has followed
  const char* why_ = "";
};

}  // namespace adapters::franka
