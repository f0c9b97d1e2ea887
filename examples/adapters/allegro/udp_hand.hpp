// A V5 Sense hand on Ethernet: HELLO, telemetry, torques.
#pragma once

#include <string>

#include "examples/adapters/allegro/guardian.hpp"
#include "examples/adapters/allegro/hand.hpp"
#include "examples/adapters/can/link.hpp"

namespace adapters::allegro {

using can::Deadline;
using can::Descriptor;
using can::wait_for;

/// Datagrams of others than the hand's address are dropped by the kernel. Samples that are not newer than the
/// last one (duplicates, late ones) are counted and dropped; time is the hand's, period times number of the
/// sample.
class UdpHand {
 public:
  /// Binds to `local_port` (0: any); the hand is at `host:port`. Throws `ConnectionError`.
  UdpHand(const std::string& host, std::uint16_t port = sense_port, std::uint16_t local_port = 0);
  UdpHand(UdpHand&&) = default;

  /// HELLO and serial number, each as often as the options say.
  Introduction connect(const HandOptions& options);
  skinctl::Heard next(Reading& reading, Deadline deadline) noexcept;
  bool send(const std::array<std::int16_t, 16>& value) noexcept;
  /// Nothing: the hand reports its faults by itself.
  void ask() noexcept {}
  /// Three times no torque: the protocol has no servo off.
  void off() noexcept;

  [[nodiscard]] Guardian::Words last_words() const { return last_words_of_udp(); }
  [[nodiscard]] int handle() const noexcept { return fd_.get(); }
  [[nodiscard]] const Condition& condition() const noexcept { return condition_; }
  [[nodiscard]] const char* error() const noexcept { return error_; }

 private:
  Read receive(std::optional<Datagram>& d, Deadline deadline) noexcept;
  bool write(std::span<const std::uint8_t> bytes) noexcept;
  std::optional<Datagram> ask_for(DatagramType request, DatagramType answer);
  [[nodiscard]] std::uint32_t milliseconds() const noexcept;
  /// Whether this datagram was a newer sample of positions.
  bool take(const Datagram& d, Reading& reading) noexcept;

  Descriptor fd_;
  HandOptions options_;
  Condition condition_;
  std::array<std::uint8_t, 2048> buffer_{};
  std::uint32_t sequence_ = 0, newest_ = 0;
  std::int64_t sample_ = 0;  ///< since the first one, without wrap
  bool heard_ = false, on_ = false;
  const char* error_ = "";
};

}  // namespace adapters::allegro
