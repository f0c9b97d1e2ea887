#include "examples/adapters/allegro/udp_hand.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace adapters::allegro {
namespace {
using Clock = std::chrono::steady_clock;
/// A sample so far back is a hand that began anew.
constexpr std::int32_t restart = -1000;
}  // namespace

UdpHand::UdpHand(const std::string& host, std::uint16_t port, std::uint16_t local_port)
    : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  const auto fail = [&](const std::string& what) {
    throw ConnectionError(what + ": " + std::strerror(errno));
  };
  if (fd_.get() < 0) fail("no UDP socket");
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(port);
  if (::inet_pton(AF_INET, host.c_str(), &peer.sin_addr) != 1)
    throw ConnectionError("'" + host + "' is no IPv4 address of a hand");
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(local_port);
  here.sin_addr.s_addr = (ntohl(peer.sin_addr.s_addr) >> 24) == 127 ? htonl(INADDR_LOOPBACK) : INADDR_ANY;
  if (::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&here), sizeof here) < 0)
    fail("UDP port " + std::to_string(local_port));
  if (::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer) < 0)
    fail("hand at " + host);
}

std::uint32_t UdpHand::milliseconds() const noexcept {
  return static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now().time_since_epoch()).count());
}

Read UdpHand::receive(std::optional<Datagram>& d, Deadline deadline) noexcept {
  for (;;) {
    const auto n = ::recv(fd_.get(), buffer_.data(), buffer_.size(), 0);
    if (n >= 0) {
      d = parse({buffer_.data(), static_cast<std::size_t>(n)});
      if (!d) ++condition_.nonsense;
      return Read::some;
    }
    // A port where nobody listens (yet, or any more) answers with a refusal: that is silence.
    const bool later = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ECONNREFUSED;
    if (!later) return Read::closed;
    if (!wait_for(fd_.get(), POLLIN, deadline) || Clock::now() >= deadline) return Read::nothing;
  }
}

bool UdpHand::write(std::span<const std::uint8_t> bytes) noexcept {
  const auto deadline = Clock::now() + options_.sending;
  for (;;) {
    const auto n = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n == static_cast<ssize_t>(bytes.size())) return true;
    if (n >= 0) return false;
    if (errno == ECONNREFUSED && Clock::now() < deadline) continue;  // of an earlier datagram
    if (errno == ECONNREFUSED) return true;                          // silence will end it, if it lasts
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOBUFS) return false;
    if (Clock::now() >= deadline || !wait_for(fd_.get(), POLLOUT, deadline)) return false;
  }
}

std::optional<Datagram> UdpHand::ask_for(DatagramType request, DatagramType answer) {
  for (unsigned t = 0; t < options_.tries; ++t) {
    if (!write(plain(request, sequence_++, milliseconds())))
      throw ConnectionError(std::string("cannot send to the hand: ") + std::strerror(errno));
    const auto deadline = Clock::now() + options_.answer;
    std::optional<Datagram> d;
    while (Clock::now() < deadline) {
      const Read got = receive(d, deadline);
      if (got == Read::closed) throw ConnectionError("the UDP socket is gone");
      if (got == Read::some && d && d->type == answer) return d;
    }
  }
  return std::nullopt;
}

Introduction UdpHand::connect(const HandOptions& options) {
  options.check();
  skinctl::require(options.generation == Generation::v5_sense, "generation of a hand by UDP",
                   static_cast<double>(options.generation), "V5 Sense");
  options_ = options;
  const std::string waited =
      std::to_string(options.tries) + " times, " + std::to_string(options.answer.count()) + " ms each";
  const auto hello = ask_for(DatagramType::hello, DatagramType::hello_answer);
  if (!hello) throw ConnectionError("the hand does not answer HELLO: asked " + waited);
  Introduction who;
  const auto bytes = hello_answer(*hello);
  if (!bytes) throw ConnectionError("the hand's answer to HELLO is too short: another version?");
  Frame info;
  info.id = message::info << 2;
  info.size = 7;
  std::copy(bytes->begin(), bytes->end(), info.data.begin());
  const Message m = decode(info, options.generation);
  if (const auto* i = std::get_if<Info>(&m)) who.info = *i;
  require_generation(options, who.info);
  const auto serial = ask_for(DatagramType::serial, DatagramType::serial_answer);
  const auto text = serial ? serial_answer(*serial) : std::nullopt;
  if (!text) throw ConnectionError("the hand does not say its serial number: asked " + waited);
  Frame number;
  number.id = message::serial << 2;
  number.size = 8;
  number.data = *text;
  const Message n = decode(number, options.generation);
  const auto& says = std::get<Serial>(n);
  who.serial.assign(says.text.begin(), says.text.end());
  who.side = agreed_side(options, says.side());
  who.gears = gears(options.generation, options.geared);
  condition_ = {};
  condition_.temperature = who.info.temperature;
  heard_ = false;
  on_ = true;
  return who;
}

bool UdpHand::take(const Datagram& d, Reading& reading) noexcept {
  if (const auto fault = fault_mask(d)) {
    condition_.failed_motors |= fault->motors;
  } else if (const auto error = motor_error(d)) {
    const unsigned joint = error->joint == 0 ? 0u : error->joint - 1u;
    condition_.failed_motors |= 1u << (joint & 31u);
  } else if (const auto t = telemetry(d)) {
    const auto ahead = static_cast<std::int32_t>(t->sample - newest_);
    if (heard_ && ahead <= 0) {
      if (ahead < restart) error_ = "the hand began anew";
      ++condition_.duplicates;
      return false;
    }
    if (heard_) {
      sample_ += ahead;
      condition_.incomplete += static_cast<std::uint64_t>(ahead - 1);
    }
    heard_ = true;
    newest_ = t->sample;
    reading.stamp = std::chrono::milliseconds(options_.period()) * sample_;
    reading.number = t->sample;
    reading.count = t->position;
    condition_.tactile = t->tactile;
    condition_.tactile_stamp = reading.stamp;
    ++condition_.tactile_number;
    for (std::size_t i = 0; i < 16; ++i) condition_.milliampere[i] = t->current[i];
    return true;
  } else {
    ++condition_.nonsense;
  }
  return false;
}

skinctl::Heard UdpHand::next(Reading& reading, Deadline deadline) noexcept {
  using skinctl::Heard;
  bool complete = false;
  std::optional<Datagram> d;
  for (int k = 0; k < most_frames_at_once; ++k) {
    const Read got = receive(d, complete ? Clock::time_point{} : deadline);
    if (got == Read::closed) {
      error_ = "the UDP socket is gone";
      return Heard::lost;
    }
    if (got == Read::nothing) break;
    if (d && take(*d, reading)) complete = true;
    if (*error_ != 0) return Heard::lost;
  }
  return complete ? Heard::state : Heard::silent;
}

bool UdpHand::send(const std::array<std::int16_t, 16>& value) noexcept {
  return write(torques(value, sequence_++, milliseconds()));
}

void UdpHand::off() noexcept {
  if (!on_) return;
  on_ = false;
  for (int k = 0; k < 3; ++k) static_cast<void>(send({}));
}

}  // namespace adapters::allegro
