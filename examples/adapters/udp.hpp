// A UDP socket with deadlines, for a device that has one peer.
#pragma once

#include <netinet/in.h>

#include <span>
#include <string>

#include "examples/adapters/can/link.hpp"

namespace adapters {

/// One datagram at a time; nothing waits longer than it is told. Once a peer is kept, the kernel drops the
/// datagrams of all others.
class UdpSocket {
 public:
  UdpSocket() = default;
  /// Waits at `address:port` (port 0: any) for datagrams from `from`, an IPv4 address; empty: from anybody.
  /// Throws `ConnectionError`.
  [[nodiscard]] static UdpSocket at(const std::string& address, std::uint16_t port,
                                    const std::string& from = {});
  /// Sends to `host:port`, an IPv4 address, and hears nobody else. Throws `ConnectionError`.
  [[nodiscard]] static UdpSocket to(const std::string& host, std::uint16_t port);

  /// The next datagram, waiting for it until `deadline`; `closed`: the socket is broken. A port where nobody
  /// listens is silence. What is longer than `into` comes as 0 bytes.
  Read receive(std::span<std::uint8_t> into, std::size_t& count, can::Deadline deadline) noexcept;
  /// Keeps the sender of the newest datagram as the peer.
  bool keep_peer() noexcept;
  /// To the peer, or where none is kept to the sender of the newest datagram. A full queue or a port where
  /// nobody listens loses the datagram, as a network does; false: the socket is broken.
  bool send(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] std::uint16_t port() const noexcept;
  void close() noexcept { fd_.close(); }

 private:
  explicit UdpSocket(can::Descriptor fd) noexcept : fd_(std::move(fd)) {}
  can::Descriptor fd_;
  sockaddr_in newest_{};
  in_addr_t only_ = INADDR_ANY;
  bool kept_ = false;
};

}  // namespace adapters
