// KUKA arms by position: the Robot Sensor Interface as a robot that is the clock.
#pragma once

#include <cmath>
#include <string>

#include "examples/adapters/robot_clock.hpp"
#include "examples/adapters/rsi/messages.hpp"

namespace adapters::rsi {

enum class Correction : unsigned char {
  absolute,  ///< RSI_ON(#ABSOLUTE): from where the arm stood at the start
  relative   ///< RSI_ON(#RELATIVE): added up by the controller; an answer that is lost ends the run
};

/// As the user's RSI configuration says it.
struct Options {
  std::string bind = "127.0.0.1";  ///< address of this computer: IP_NUMBER
  std::uint16_t port = 59152;      ///< PORT
  std::string from{};              ///< address of the controller; empty: of the first that sends
  std::string type = "ImFree";     ///< SENTYPE
  Correction correction = Correction::absolute;
  double max_correction = 90;  ///< of each axis, as of AXISCORR and AXISCORRMON [deg]
  skinctl::Nanoseconds period = skinctl::Nanoseconds(4'000'000);  ///< 4 ms, #IPO_FAST; 12 ms, #IPO
};

/// A `ClockProtocol`. Sends nothing by itself: the controller begins with RSI_ON.
class Rsi {
 public:
  static constexpr std::size_t joints = 6;
  static constexpr bool answers_every_number = false;  // an old IPOC is a late answer

  /// Throws `ConfigurationError`.
  explicit Rsi(const Options& options);
  void open(can::Deadline) noexcept { started_ = false; }
  void close(can::Deadline) noexcept { socket_.close(); }
  [[nodiscard]] UdpSocket& socket() noexcept { return socket_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return options_.period; }
  ClockFault read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept;
  std::size_t answer(std::uint64_t number, const SixJoints& q, bool last,
                     std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] const char* refuses(const SixJoints& q) const noexcept;
  [[nodiscard]] const char* why() const noexcept { return why_; }
  [[nodiscard]] std::string place() const {
    return "at " + options_.bind + ":" + std::to_string(socket_.port());
  }
  /// The greatest correction to either side [rad].
  [[nodiscard]] double max_correction() const noexcept;

 private:
  Options options_;
  UdpSocket socket_;
  SixJoints start_{}, sum_{};  ///< where the arm stood; where the corrections have led [rad]
  std::uint32_t late_ = 0;
  bool started_ = false;
  const char* why_ = "";
};

}  // namespace adapters::rsi
