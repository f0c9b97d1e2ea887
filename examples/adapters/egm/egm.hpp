// ABB arms by position: Externally Guided Motion as a robot that is the clock.
#pragma once

#include <string>

#include "examples/adapters/egm/messages.hpp"
#include "examples/adapters/robot_clock.hpp"

namespace adapters::egm {

/// As the RAPID program says it: EGMSetupUC with a UdpUc device, EGMActJoint `\SampleRate`, EGMRunJoint with
/// `\PosCorrGain:=1` and a `\CondTime` that never ends.
struct Options {
  std::string bind = "127.0.0.1";  ///< address of this computer: that of the UdpUc device
  std::uint16_t port = 6510;       ///< of the same
  std::string from{};              ///< address of the controller; empty: of the first that sends
  skinctl::Nanoseconds period = skinctl::Nanoseconds(4'000'000);  ///< `\SampleRate`: 4 ms, or multiples
};

/// A `ClockProtocol`. Sends nothing by itself: the controller begins with EGMRunJoint.
class Egm {
 public:
  static constexpr std::size_t joints = 6;
  static constexpr bool answers_every_number = false;  // the newest answer counts

  /// Throws `ConfigurationError`.
  explicit Egm(const Options& options);
  void open(can::Deadline) noexcept { guided_ = false; }
  void close(can::Deadline) noexcept { socket_.close(); }
  [[nodiscard]] UdpSocket& socket() noexcept { return socket_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return options_.period; }
  ClockFault read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept;
  /// The last answer has no mark of its own: the controller holds it, and ends at `\CommTimeout`.
  std::size_t answer(std::uint64_t number, const SixJoints& q, bool last,
                     std::span<std::uint8_t> out) noexcept;
  [[nodiscard]] const char* refuses(const SixJoints&) const noexcept { return nullptr; }
  [[nodiscard]] const char* why() const noexcept { return why_; }
  [[nodiscard]] std::string place() const {
    return "at " + options_.bind + ":" + std::to_string(socket_.port());
  }

 private:
  Options options_;
  UdpSocket socket_;
  std::uint32_t sent_ = 0;  ///< number of the next answer
  bool guided_ = false;     ///< the controller has followed
  const char* why_ = "";
};

}  // namespace adapters::egm
