#include "examples/adapters/udp.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace adapters {
namespace {

sockaddr_in ipv4(const std::string& address, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &out.sin_addr) != 1)
    throw ConnectionError("'" + address + "' is no IPv4 address");
  return out;
}
const sockaddr* raw(const sockaddr_in& a) {
  return reinterpret_cast<const sockaddr*>(&a);
}
can::Descriptor new_socket() {
  can::Descriptor fd(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (fd.get() < 0) throw ConnectionError(std::string("no UDP socket: ") + std::strerror(errno));
  return fd;
}

}  // namespace

UdpSocket UdpSocket::at(const std::string& address, std::uint16_t port, const std::string& from) {
  UdpSocket out(new_socket());
  const sockaddr_in here = ipv4(address, port);
  if (!from.empty()) out.only_ = ipv4(from, 0).sin_addr.s_addr;
  if (::bind(out.fd_.get(), raw(here), sizeof here) < 0)
    throw ConnectionError("cannot wait at " + address + ":" + std::to_string(port) + ": " +
                          std::strerror(errno) + ". Is that an address of this computer, and the port free?");
  return out;
}

UdpSocket UdpSocket::to(const std::string& host, std::uint16_t port) {
  UdpSocket out(new_socket());
  out.newest_ = ipv4(host, port);
  if (!out.keep_peer())
    throw ConnectionError("no way to " + host + ":" + std::to_string(port) + ": " + std::strerror(errno));
  return out;
}

bool UdpSocket::keep_peer() noexcept {
  kept_ = kept_ || ::connect(fd_.get(), raw(newest_), sizeof newest_) == 0;
  return kept_;
}

std::uint16_t UdpSocket::port() const noexcept {
  sockaddr_in here{};
  socklen_t size = sizeof here;
  return ::getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&here), &size) == 0 ? ntohs(here.sin_port)
                                                                                  : std::uint16_t(0);
}

Read UdpSocket::receive(std::span<std::uint8_t> into, std::size_t& count, can::Deadline deadline) noexcept {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const auto n =
        ::recvfrom(fd_.get(), into.data(), into.size(), MSG_TRUNC, reinterpret_cast<sockaddr*>(&from), &size);
    if (n >= 0) {
      if (only_ != INADDR_ANY && from.sin_addr.s_addr != only_) {
        if (std::chrono::steady_clock::now() >= deadline) return Read::nothing;
        continue;
      }
      if (!kept_) newest_ = from;
      count = static_cast<std::size_t>(n) <= into.size() ? static_cast<std::size_t>(n) : 0;
      return Read::some;
    }
    const bool later = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ECONNREFUSED;
    if (!later) return Read::closed;
    if (!can::wait_for(fd_.get(), POLLIN, deadline)) return Read::nothing;
  }
}

bool UdpSocket::send(std::span<const std::uint8_t> bytes) noexcept {
  for (int k = 0; k < 2; ++k) {  // the first may report an earlier datagram that nobody took
    const auto n =
        kept_ ? ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL)
              : ::sendto(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL, raw(newest_), sizeof newest_);
    if (n >= 0) return true;
    const bool lost = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ENOBUFS;
    if (errno != ECONNREFUSED) return lost;
  }
  return true;
}

}  // namespace adapters
