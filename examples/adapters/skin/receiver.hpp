// Receives skin datagrams and puts their samples on the robot's clock.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/adapters/skin/datagram.hpp"
#include "skinctl/sensing/clock_offset.hpp"

namespace adapters::skin {

struct ReceiverConfig {
  std::string address = "127.0.0.1";  ///< of this computer; 0.0.0.0 or ::, all its addresses
  std::uint16_t port = 0;             ///< 0: any
  std::string sender{};               ///< the only address that is listened to; empty: any
  /// Only datagrams of version 2 that this key made are taken, from wherever they come; none: only version 1.
  std::optional<Key> key{};
  /// With a key: sessions up to this one are refused. A program that remembers `Receiver::session` of its last
  /// run cannot be fed a recording of it.
  std::uint64_t after_session = 0;
  skinctl::Nanoseconds oldest =
      std::chrono::milliseconds(100);  ///< a sample so long before its sending is refused
  skinctl::Nanoseconds forget =
      std::chrono::milliseconds(200);  ///< after so long without datagrams another sender may begin
  std::size_t max_samples = 16384;     ///< of one poll; more stay in the socket until the next
  std::size_t max_datagrams = 1024;    ///< looked at in one poll, whoever sends them
  std::size_t buffer = 4 << 20;        ///< that the system is asked for [bytes]; see `Receiver::buffer`
  skinctl::ClockOffset::Settings clock = {};  ///< the sender's clock against the robot's
};

/// What arrived and what was refused, since the start.
struct Statistics {
  std::uint64_t datagrams = 0, samples = 0;
  std::uint64_t lost = 0;         ///< gaps in the sequence numbers
  std::uint64_t nonsense = 0;     ///< not a datagram of ours
  std::uint64_t strangers = 0;    ///< from another sender
  std::uint64_t forged = 0;       ///< with a key: not made by it
  std::uint64_t replayed = 0;     ///< with a key: of an old session
  std::uint64_t late = 0;         ///< repeated or overtaken
  std::uint64_t bad_samples = 0;  ///< implausible
  std::uint64_t untimed = 0;      ///< samples before the sender's clock was known, see `ClockOffset`
  std::uint64_t leaps = 0;        ///< of the sender's clock

  /// Datagrams that somebody else sent, or none of ours.
  [[nodiscard]] std::uint64_t stray() const noexcept { return nonsense + strangers + forged + replayed; }
};

/// A bound UDP socket. Throws `ConnectionError` where it cannot be bound, `ConfigurationError` for a setting
/// that cannot work; after that nothing throws or allocates.
class Receiver {
 public:
  explicit Receiver(const ReceiverConfig& config);
  ~Receiver();

  /// The samples that have arrived, on the robot's clock, which shows `now`; the sender's clock is followed
  /// by a `ClockOffset`, which first listens for a tenth of a second.
  ///
  /// What is no datagram of the sender's is counted and dropped; the sender's own go on. Time is bounded by
  /// `max_datagrams` and `max_samples`.
  std::span<const skinctl::CellSample> poll(skinctl::Nanoseconds now) noexcept;

  /// How long nothing of the sender's has arrived, by the robot's clock.
  [[nodiscard]] skinctl::Nanoseconds silent_for(skinctl::Nanoseconds now) const noexcept {
    return now - heard_at_;
  }
  [[nodiscard]] bool heard() const noexcept { return statistics_.datagrams > 0; }
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// With a key: the newest session that was heard, or `after_session`.
  [[nodiscard]] std::uint64_t session() const noexcept { return session_; }
  /// The buffer that the system gave [bytes]. Linux cuts it at /proc/sys/net/core/rmem_max.
  [[nodiscard]] std::size_t buffer() const noexcept { return buffer_; }

 private:
  struct Batch;

  void receive(std::span<const std::uint8_t> bytes, const void* from, std::size_t from_size,
               skinctl::Nanoseconds now) noexcept;
  bool admit(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
             std::size_t from_size, bool& fresh, skinctl::Nanoseconds now) noexcept;
  void take(const Datagram& datagram, skinctl::Nanoseconds now) noexcept;

  ReceiverConfig config_;
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  std::unique_ptr<Batch> batch_;
  std::array<std::uint8_t, 32> sender_{};  ///< as the system writes addresses
  std::size_t sender_size_ = 0;
  std::array<std::uint8_t, 16> only_{};  ///< `config.sender`
  std::size_t only_size_ = 0;
  std::vector<skinctl::CellSample> samples_;
  Statistics statistics_;
  std::size_t buffer_ = 0;
  std::uint64_t session_ = 0;
  bool has_sender_ = false;
  std::uint32_t newest_ = 0;
  skinctl::Nanoseconds heard_at_{};
  skinctl::ClockOffset clock_;
  skinctl::ClockOffset::Memory clock_memory_;
};

}  // namespace adapters::skin
