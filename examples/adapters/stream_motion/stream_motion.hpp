// FANUC arms by position: stream motion (option J519) as a robot that is the clock.
#pragma once

#include <string>

#include "examples/adapters/robot_clock.hpp"
#include "examples/adapters/stream_motion/packets.hpp"

namespace adapters::stream_motion {

struct Options {
  std::string host;
  std::uint16_t port = 60015;
  Timeout answer{500};  ///< of each question before the start, asked three times
};

/// A `ClockProtocol`. The program STREAM_MOTN, or what calls it, has to run on the controller; the streamed
/// joints are those of a URDF: J3 is relative to link 2.
class StreamMotion {
 public:
  static constexpr std::size_t joints = 6;
  static constexpr bool answers_every_number = true;  // the controller counts commands

  /// Throws `ConnectionError`.
  explicit StreamMotion(const Options& options);
  /// Capability, limits of the six axes, start.
  void open(can::Deadline deadline);
  /// Waits until the arm rests, and stops the stream.
  void close(can::Deadline deadline) noexcept;
  [[nodiscard]] UdpSocket& socket() noexcept { return socket_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return period_; }
  ClockFault read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept;
  std::size_t answer(std::uint64_t number, const SixJoints& q, bool last,
                     std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] const char* refuses(const SixJoints& q) const noexcept;
  [[nodiscard]] const char* why() const noexcept { return why_; }
  [[nodiscard]] std::string place() const { return options_.host + ":" + std::to_string(options_.port); }
  /// Velocity, acceleration and jerk that an axis may have at any speed and load [rad/s], ...
  [[nodiscard]] const std::array<SixJoints, 3>& limits() const noexcept { return limits_; }
  [[nodiscard]] std::uint32_t version() const noexcept { return version_; }

 private:
  template <class Question, class Answer, class Fits>
  void ask(const Question& question, Answer& answer, const char* name, can::Deadline deadline, Fits&& fits);
  template <class Packet>
  bool send(const Packet& packet) noexcept;

  Options options_;
  UdpSocket socket_;
  std::array<SixJoints, 3> limits_{};
  skinctl::Nanoseconds period_ = skinctl::Nanoseconds(8'000'000);
  std::uint32_t version_ = 3;
  std::array<double, 3> other_axes_{};  ///< 7 to 9, which stay [deg]
  bool ready_ = false, started_ = false, ended_ = false;
  const char* why_ = "";
};

}  // namespace adapters::stream_motion
