// Sends skin datagrams: what a bridge from another skin, or a simulation, needs.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/adapters/skin/datagram.hpp"

namespace adapters::skin {

/// Packs samples into datagrams to one receiver. Throws `ConnectionError` for an address that is none; sending does
/// not throw or wait.
class Sender {
 public:
  /// With a key: version 2.
  Sender(const std::string& host, std::uint16_t port, std::optional<Key> key = {});

  /// Sends `samples`, whose times are of the clock that shows `now`; without samples a heartbeat. Samples whose time
  /// is after `now` are refused by the receiver. Returns how many datagrams went out.
  std::size_t send(std::span<const skinctl::CellSample> samples, skinctl::Nanoseconds now) noexcept;
  /// Datagrams that the system did not take.
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_; }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  std::optional<Key> key_;
  std::array<std::uint8_t, largest + session_size + tag_size> buffer_{};
  std::uint64_t session_ = 0, failed_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace adapters::skin
