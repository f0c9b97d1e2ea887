// A TCP stream with deadlines: what both ends of a robot's protocols need and no more.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace adapters {

/// A peer that cannot be reached, has gone, or talks nonsense. The text says who and what.
class ConnectionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using Timeout = std::chrono::milliseconds;
/// What is left of it, at least 0.
inline Timeout left_until(std::chrono::steady_clock::time_point deadline) {
  return std::max(Timeout(0), std::chrono::ceil<Timeout>(deadline - std::chrono::steady_clock::now()));
}

/// How reading from a stream ended.
enum class Read { some, nothing, closed };

/// A connected stream. Nothing here waits longer than it is told.
class Stream {
 public:
  Stream() : socket_(io_) {}
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Connects to `host:port` as `peer` (its name in errors). Throws `ConnectionError`.
  void connect(const std::string& host, std::uint16_t port, const std::string& peer, Timeout timeout);
  /// Waits for a connection on `acceptor`; only one from `from`, if that is an address, is taken. Throws
  /// `ConnectionError`.
  void accept(boost::asio::ip::tcp::acceptor& acceptor, const boost::asio::ip::address& from,
              const std::string& peer, Timeout timeout);
  /// Takes a connection that waits at `acceptor`, which does not block; false where there is none.
  bool accept_waiting(boost::asio::ip::tcp::acceptor& acceptor) noexcept;
  /// For `poll`.
  [[nodiscard]] int handle() noexcept { return socket_.native_handle(); }
  /// This computer's address on the way to the peer.
  [[nodiscard]] std::string local_address() const;
  [[nodiscard]] boost::asio::ip::address remote_address() const;
  [[nodiscard]] bool is_open() const noexcept { return socket_.is_open(); }

  /// What has arrived, waiting at most `timeout` for the first byte.
  Read read_some(std::span<std::uint8_t> into, std::size_t& count, Timeout timeout) noexcept;
  /// Sends all of it or fails, within `timeout`.
  bool write(std::span<const std::uint8_t> bytes, Timeout timeout) noexcept;
  /// How long TCP waits for an acknowledgement beyond a round trip before it sends again what may be lost:
  /// Linux 200 ms else, and each time twice as long. So late it finds a packet lost of which the repetition, or
  /// its acknowledgement, is lost too: until then it sends nothing new. False: an older kernel, which takes the
  /// wait only for a route (`ip route change ... rto_min 4ms`); it does not double there either.
  bool set_retransmission_wait(Timeout wait) noexcept;
  void close() noexcept;

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_;
};

/// Binds `address:port` (port 0: any) to wait for connections. Throws `ConnectionError`.
boost::asio::ip::tcp::acceptor listen(boost::asio::io_context& io, const std::string& address,
                                      std::uint16_t port);

}  // namespace adapters
