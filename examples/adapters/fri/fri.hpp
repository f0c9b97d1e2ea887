// KUKA's LBR iiwa by joint impedance: the Fast Robot Interface as a robot that is the clock.
#pragma once

#include <string>

#include "examples/adapters/fri/messages.hpp"
#include "examples/adapters/robot_clock.hpp"

namespace adapters::fri {

/// As the Java program says it: an FRIConfiguration, an FRISession, and an FRIJointOverlay over a position
/// hold.
struct Options {
  std::string bind = "127.0.0.1";  ///< address of this computer: that of createRemoteConfiguration
  std::uint16_t port = 30200;      ///< of this computer, as the same says it
  std::string from{};              ///< address of the controller; empty: of the first that sends
  skinctl::Nanoseconds period = skinctl::Nanoseconds(4'000'000);  ///< send period times receive multiplier
  Control control = Control::joint_impedance;  ///< mode of the motion under the overlay; or position
  Overlay overlay = Overlay::position;         ///< ClientCommandMode; or torque, within 2 ms
};

/// A `ClockProtocol`. Keeps a session alive by its own answers until the controller commands by ours.
class Fri {
 public:
  static constexpr std::size_t joints = fri::joints;
  static constexpr bool answers_every_number = false;  // the newest answer counts
  static constexpr bool finds_torque = true;

  /// Throws `ConfigurationError`, `ConnectionError`.
  explicit Fri(const Options& options);
  void open(can::Deadline) noexcept { commanded_ = false; }
  void close(can::Deadline) noexcept { socket_.close(); }
  [[nodiscard]] UdpSocket& socket() noexcept { return socket_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return options_.period; }
  ClockFault read(std::span<const std::uint8_t> bytes, ClockedStateOf<joints>& state) noexcept;
  /// The last answer has no mark of its own: without answers the controller ends the overlay.
  std::size_t answer(std::uint64_t number, const SevenJoints& q, bool last,
                     std::span<std::uint8_t> out) noexcept;
  /// Torque beside the positions of the answers that follow [N m]; an overlay of positions leaves it out.
  void beside(const SevenJoints& torque) noexcept { torque_ = torque; }
  [[nodiscard]] const char* refuses(const SevenJoints&) const noexcept { return nullptr; }
  [[nodiscard]] const char* why() const noexcept { return why_; }
  [[nodiscard]] std::string place() const {
    return "at " + options_.bind + ":" + std::to_string(socket_.port());
  }

 private:
  [[nodiscard]] ClockFault judge(const Monitoring& m) noexcept;
  bool due(const Monitoring& m, std::int64_t& cycle) noexcept;

  Options options_;
  UdpSocket socket_;
  SevenJoints torque_{};
  std::uint32_t sent_ = 0;  ///< counter of the next answer
  std::uint32_t first_ = 0,
                heard_ = 0;  ///< counter from which cycles are numbered; of the message to be answered
  std::int64_t cycle_ = -1;  ///< of the message to be answered; -1: none has come
  bool commanded_ = false;   ///< the controller has followed
  const char* why_ = "";
};

}  // namespace adapters::fri
