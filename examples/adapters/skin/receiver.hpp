// Receives skin datagrams and puts their samples on the robot's clock.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "examples/adapters/skin/datagram.hpp"
#include "skinctl/sensing/clock_offset.hpp"

namespace adapters::skin {

struct ReceiverConfig {
  std::string address = "127.0.0.1";  ///< of this computer
  std::uint16_t port = 0;             ///< 0: any
  skinctl::Nanoseconds oldest =
      std::chrono::milliseconds(100);  ///< a sample so long before its sending is refused
  skinctl::Nanoseconds forget =
      std::chrono::milliseconds(200);         ///< after so long without datagrams another sender may begin
  std::size_t max_samples = 8192;             ///< of one poll; more stay in the socket until the next
  skinctl::ClockOffset::Settings clock = {};  ///< the sender's clock against the robot's
};

/// What arrived and what was refused, since the start.
struct Statistics {
  std::uint64_t datagrams = 0, samples = 0;
  std::uint64_t lost = 0;         ///< gaps in the sequence numbers
  std::uint64_t nonsense = 0;     ///< not a datagram of ours
  std::uint64_t strangers = 0;    ///< from another sender
  std::uint64_t late = 0;         ///< repeated or overtaken
  std::uint64_t bad_samples = 0;  ///< implausible
  std::uint64_t untimed = 0;      ///< samples before the sender's clock was known, see `ClockOffset`
  std::uint64_t leaps = 0;        ///< of the sender's clock
};

/// A bound UDP socket. Throws `ConnectionError` where it cannot be bound; after that nothing throws or
/// allocates.
class Receiver {
 public:
  explicit Receiver(const ReceiverConfig& config);

  /// The samples that have arrived, on the robot's clock, which shows `now`; the sender's clock is followed by a
  /// `ClockOffset`, which first listens for a tenth of a second.
  std::span<const skinctl::CellSample> poll(skinctl::Nanoseconds now) noexcept;

  /// How long nothing has arrived, by the robot's clock.
  [[nodiscard]] skinctl::Nanoseconds silent_for(skinctl::Nanoseconds now) const noexcept {
    return now - heard_at_;
  }
  [[nodiscard]] bool heard() const noexcept { return statistics_.datagrams > 0; }
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }

 private:
  void take(const Datagram& datagram, skinctl::Nanoseconds now) noexcept;

  ReceiverConfig config_;
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint sender_;
  std::vector<skinctl::CellSample> samples_;
  Statistics statistics_;
  bool has_sender_ = false;
  std::uint32_t newest_ = 0;
  skinctl::Nanoseconds heard_at_{};
  skinctl::ClockOffset clock_;
  skinctl::ClockOffset::Memory clock_memory_;
};

}  // namespace adapters::skin
