#include "examples/fault_table/plain_stream.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <atomic>
#include <exception>
#include <future>

#include "examples/adapters/socket.hpp"

namespace fault_table {
namespace {

using Clock = std::chrono::steady_clock;
using adapters::Timeout;

void prepare(adapters::Stream& out, const PlainStream& stream) {
  if (stream.retransmission > 0 && !out.set_retransmission_wait(Timeout(stream.retransmission)))
    throw adapters::ConnectionError("this kernel does not let a socket choose when it sends again");
  const std::string& name = stream.congestion;  // after the wait, which chooses reno
  if (!name.empty() && ::setsockopt(out.handle(), IPPROTO_TCP, TCP_CONGESTION, name.data(),
                                    static_cast<socklen_t>(name.size())) != 0)
    throw adapters::ConnectionError("this kernel gives no congestion control '" + name + "'");
}

/// Until the sender hangs up.
std::vector<double> listen_to(adapters::Stream& in, double longer_than) {
  std::vector<double> out;
  std::array<std::uint8_t, 4096> room{};
  auto last = Clock::now();
  for (bool first = true;; first = false) {
    std::size_t count = 0;
    if (in.read_some(room, count, Timeout(10000)) != adapters::Read::some) return out;
    const auto now = Clock::now();
    const double since = std::chrono::duration<double>(now - last).count();
    if (!first && since > longer_than) out.push_back(since);
    last = now;
  }
}

}  // namespace

std::vector<double> stalls(NetworkLink& link, const LinkFault& fault, const PlainStream& stream,
                           double seconds, const FaultyTime& when) {
  boost::asio::io_context io;
  std::promise<std::uint16_t> port;
  std::vector<double> out;
  std::exception_ptr reading, writing;
  adapters::Stream in, sender;
  std::thread reader = link.at_robot([&] {
    auto acceptor = adapters::listen(io, NetworkLink::robot_address, 0);
    port.set_value(acceptor.local_endpoint().port());
    try {
      in.accept(acceptor, {}, "the sender", Timeout(5000));
      out = listen_to(in, 3 / stream.rate);
    } catch (...) {
      reading = std::current_exception();
    }
  });
  std::thread writer = link.at_job([&] {
    try {
      sender.connect(NetworkLink::robot_address, port.get_future().get(), "the reader", Timeout(5000));
      prepare(sender, stream);
      const std::vector<std::uint8_t> message(stream.bytes);
      const auto begin = Clock::now();
      const auto messages = static_cast<std::int64_t>(seconds * stream.rate);
      bool faulty = false;
      for (std::int64_t k = 0; k < messages; ++k) {
        const double t = double(k) / stream.rate;
        if (const bool is = t >= when.from && t < when.until; is != faulty)
          faulty = is, link.set(is ? fault : LinkFault{});
        if (!sender.write(message, Timeout(1000)))
          throw adapters::ConnectionError("the plain stream broke: nothing was taken for a second");
        std::this_thread::sleep_until(
            begin + std::chrono::nanoseconds(std::int64_t(1e9 * double(k + 1) / stream.rate)));
      }
    } catch (...) {
      writing = std::current_exception();
    }
    link.set({});
    sender.close();
  });
  writer.join();
  reader.join();
  if (writing) std::rethrow_exception(writing);
  if (reading) std::rethrow_exception(reading);
  return out;
}

}  // namespace fault_table
