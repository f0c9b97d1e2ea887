#include "examples/adapters/socket.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/address.hpp>
#include <cerrno>
#include <string_view>

namespace adapters {
namespace {

using Clock = std::chrono::steady_clock;

/// Waits until the socket is ready; false when the time is over.
bool ready(int handle, short events, Clock::time_point deadline) noexcept {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd entry{handle, events, 0};
    const int n = ::poll(&entry, 1, left < 0 ? 0 : static_cast<int>(left));
    if (n > 0) return true;
    if (n == 0 || errno != EINTR) return false;
    if (Clock::now() >= deadline) return false;
  }
}

}  // namespace

void Stream::connect(const std::string& host, std::uint16_t port, const std::string& peer, Timeout timeout) {
  close();
  boost::system::error_code error = boost::asio::error::timed_out;
  try {
    boost::asio::ip::tcp::resolver resolver(io_);
    const auto endpoints = resolver.resolve(host, std::to_string(port));
    boost::asio::async_connect(socket_, endpoints,
                               [&](const boost::system::error_code& e, const auto&) { error = e; });
    io_.restart();
    io_.run_for(timeout);
  } catch (const boost::system::system_error& e) {
    error = e.code();
  }
  if (error) {
    close();
    io_.restart();
    io_.poll();
    throw ConnectionError("cannot reach " + peer + " at " + host + ":" + std::to_string(port) + ": " +
                          error.message());
  }
  socket_.set_option(boost::asio::ip::tcp::no_delay(true), error);
  socket_.non_blocking(true, error);
}

void Stream::accept(boost::asio::ip::tcp::acceptor& acceptor, const boost::asio::ip::address& from,
                    const std::string& peer, Timeout timeout) {
  close();
  const auto deadline = Clock::now() + timeout;
  boost::system::error_code error;
  acceptor.non_blocking(true, error);
  while (ready(acceptor.native_handle(), POLLIN, deadline)) {
    boost::asio::ip::tcp::socket candidate(io_);
    boost::asio::ip::tcp::endpoint who;
    acceptor.accept(candidate, who, error);
    if (error) continue;
    if (!from.is_unspecified() && who.address() != from) continue;  // a stranger: hang up, go on waiting
    socket_ = std::move(candidate);
    socket_.set_option(boost::asio::ip::tcp::no_delay(true), error);
    socket_.non_blocking(true, error);
    return;
  }
  throw ConnectionError(peer + " did not connect back within " + std::to_string(timeout.count()) + " ms");
}

bool Stream::accept_waiting(boost::asio::ip::tcp::acceptor& acceptor) noexcept {
  boost::system::error_code error;
  boost::asio::ip::tcp::socket candidate(io_);
  acceptor.accept(candidate, error);
  if (error) return false;
  socket_ = std::move(candidate);
  socket_.set_option(boost::asio::ip::tcp::no_delay(true), error);
  socket_.non_blocking(true, error);
  return true;
}

std::string Stream::local_address() const {
  return socket_.local_endpoint().address().to_string();
}
boost::asio::ip::address Stream::remote_address() const {
  return socket_.remote_endpoint().address();
}

Read Stream::read_some(std::span<std::uint8_t> into, std::size_t& count, Timeout timeout) noexcept {
  count = 0;
  if (!socket_.is_open()) return Read::closed;
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    const auto n = ::recv(socket_.native_handle(), into.data(), into.size(), 0);
    if (n > 0) {
      count = static_cast<std::size_t>(n);
      return Read::some;
    }
    if (n == 0) return Read::closed;
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return Read::closed;
    if (!ready(socket_.native_handle(), POLLIN, deadline)) return Read::nothing;
  }
}

bool Stream::write(std::span<const std::uint8_t> bytes, Timeout timeout) noexcept {
  if (!socket_.is_open()) return false;
  const auto deadline = Clock::now() + timeout;
  while (!bytes.empty()) {
    const auto n = ::send(socket_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (!ready(socket_.native_handle(), POLLOUT, deadline)) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool Stream::set_retransmission_wait(Timeout wait) noexcept {
#ifdef __linux__
  constexpr int min_retransmission_us = 45;  // TCP_RTO_MIN_US, which older headers lack
  const int handle = socket_.native_handle(), yes = 1;
  // Any kernel: the wait does not double, as few packets are on their way; with BBR it would.
  constexpr std::string_view reno = "reno";
  static_cast<void>(
      ::setsockopt(handle, IPPROTO_TCP, TCP_CONGESTION, reno.data(), static_cast<socklen_t>(reno.size())));
  static_cast<void>(::setsockopt(handle, IPPROTO_TCP, TCP_THIN_LINEAR_TIMEOUTS, &yes, sizeof yes));
  // A kernel refuses what is less than two ticks of its timer, 8 ms of 250 a second.
  for (int us = static_cast<int>(wait.count()) * 1000; us < 200'000; us *= 2)
    if (::setsockopt(handle, IPPROTO_TCP, min_retransmission_us, &us, sizeof us) == 0) return true;
  return false;
#else
  static_cast<void>(wait);
  return false;
#endif
}

void Stream::close() noexcept {
  boost::system::error_code ignored;
  if (socket_.is_open()) socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
  socket_.close(ignored);
}

boost::asio::ip::tcp::acceptor listen(boost::asio::io_context& io, const std::string& address,
                                      std::uint16_t port) {
  try {
    boost::asio::ip::tcp::acceptor acceptor(io);
    const boost::asio::ip::tcp::endpoint endpoint(boost::asio::ip::make_address(address), port);
    acceptor.open(endpoint.protocol());
    acceptor.set_option(boost::asio::socket_base::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen(4);
    return acceptor;
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot listen at " + address + ":" + std::to_string(port) + ": " + e.what());
  }
}

}  // namespace adapters
