#include "examples/adapters/skin/receiver.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "examples/adapters/socket.hpp"
#include "skinctl/core/contract.hpp"

namespace adapters::skin {

using skinctl::Nanoseconds;
namespace ip = boost::asio::ip;

/// What one system call receives.
struct Receiver::Batch {
  static constexpr std::size_t size = 64;

  std::array<std::array<std::uint8_t, largest + 1>, size> bytes;  // one more, to see that one is too long
  std::array<sockaddr_storage, size> from{};
  std::array<iovec, size> part{};
  std::array<mmsghdr, size> message{};

  Batch() {
    for (std::size_t i = 0; i < size; ++i) {
      part[i] = {bytes[i].data(), bytes[i].size()};
      message[i].msg_hdr.msg_name = &from[i];
      message[i].msg_hdr.msg_iov = &part[i];
      message[i].msg_hdr.msg_iovlen = 1;
    }
  }
  /// How many datagrams arrived, at most `most`; 0 where there are none.
  std::size_t receive(int handle, std::size_t most) noexcept {
    for (std::size_t i = 0; i < most; ++i) message[i].msg_hdr.msg_namelen = sizeof(sockaddr_storage);
    const int n = ::recvmmsg(handle, message.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
};

Receiver::Receiver(const ReceiverConfig& config) : config_(config), socket_(io_), clock_(config.clock) {
  skinctl::require(config.max_samples >= max_samples && config.max_samples <= (1u << 24),
                   "skin receiver: max_samples", double(config.max_samples), "33 to 2^24");
  skinctl::require(config.max_datagrams >= 1 && config.max_datagrams <= (1u << 20),
                   "skin receiver: max_datagrams", double(config.max_datagrams), "1 to 2^20");
  skinctl::require(config.buffer <= (1u << 30), "skin receiver: buffer", double(config.buffer), "up to 2^30");
  try {
    const ip::udp::endpoint endpoint(ip::make_address(config.address), config.port);
    if (!config.sender.empty()) {
      const auto only = ip::make_address(config.sender);
      if (only.is_v4() != endpoint.address().is_v4())
        skinctl::refuse("skinctl: skin receiver: sender = " + config.sender +
                        ", allowed: an address of the same family as " + config.address);
      only_size_ = only.is_v4() ? 4 : 16;
      if (only.is_v4())
        std::memcpy(only_.data(), only.to_v4().to_bytes().data(), only_size_);
      else
        std::memcpy(only_.data(), only.to_v6().to_bytes().data(), only_size_);
    }
    socket_.open(endpoint.protocol());
    const int handle = socket_.native_handle();
    const int asked = static_cast<int>(config.buffer);
    // Beyond rmem_max only an administrator gets it.
    if (::setsockopt(handle, SOL_SOCKET, SO_RCVBUFFORCE, &asked, sizeof asked) != 0)
      static_cast<void>(::setsockopt(handle, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked));
    int given = 0;
    socklen_t size = sizeof given;
    if (::getsockopt(handle, SOL_SOCKET, SO_RCVBUF, &given, &size) == 0)
      buffer_ = static_cast<std::size_t>(given) / 2;  // Linux counts its own part as well
    socket_.bind(endpoint);
    socket_.non_blocking(true);
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot receive skin at " + config.address + ":" + std::to_string(config.port) +
                          ": " + e.what());
  }
  session_ = config.after_session;
  batch_ = std::make_unique<Batch>();
  samples_.reserve(config.max_samples);
}
Receiver::~Receiver() = default;

std::span<const skinctl::CellSample> Receiver::poll(Nanoseconds now) noexcept {
  samples_.clear();
  // Bounded: a flood cannot keep the loop here.
  std::size_t left = config_.max_datagrams;
  while (left > 0) {
    const std::size_t room = (config_.max_samples - samples_.size()) / max_samples;
    const std::size_t most = std::min({Batch::size, left, room});
    const std::size_t n = most > 0 ? batch_->receive(socket_.native_handle(), most) : 0;
    for (std::size_t i = 0; i < n; ++i) {
      const mmsghdr& message = batch_->message[i];
      receive(std::span(batch_->bytes[i]).first(std::min<std::size_t>(message.msg_len, largest + 1)),
              message.msg_hdr.msg_name, message.msg_hdr.msg_namelen, now);
    }
    left -= n;
    if (n < most || n == 0) break;
  }
  return samples_;
}

void Receiver::receive(std::span<const std::uint8_t> bytes, const void* from, std::size_t from_size,
                       Nanoseconds now) noexcept {
  Datagram datagram;
  if (!parse(bytes, datagram)) {
    ++statistics_.nonsense;
    return;
  }
  bool fresh = false;
  if (!admit(datagram, bytes, from, from_size, fresh, now)) return;
  if (fresh) {
    has_sender_ = true;
    sender_size_ = std::min(from_size, sender_.size());
    std::memcpy(sender_.data(), from, sender_size_);
    session_ = datagram.session;
    clock_memory_ = {};
  } else {
    // Sequence numbers of a sealed session end before they begin anew.
    const std::int64_t step = datagram.sealed ? std::int64_t(datagram.sequence) - std::int64_t(newest_)
                                              : static_cast<std::int32_t>(datagram.sequence - newest_);
    if (step <= 0) {
      ++statistics_.late;
      return;
    }
    statistics_.lost += static_cast<std::uint64_t>(step - 1);
  }
  newest_ = datagram.sequence;
  heard_at_ = now;
  ++statistics_.datagrams;
  take(datagram, now);
}

/// Whether the datagram is one of our sender's; `fresh` if it is the first one.
bool Receiver::admit(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
                     std::size_t from_size, bool& fresh, Nanoseconds now) noexcept {
  const auto* address = static_cast<const std::uint8_t*>(from);
  const std::size_t at =
      only_size_ == 4 ? offsetof(sockaddr_in, sin_addr) : offsetof(sockaddr_in6, sin6_addr);
  if (only_size_ > 0 &&
      (from_size < at + only_size_ || std::memcmp(address + at, only_.data(), only_size_) != 0)) {
    ++statistics_.strangers;
    return false;
  }
  if (config_.key) {
    if (!datagram.sealed || !config_.key->made(bytes)) {
      ++statistics_.forged;
      return false;
    }
    fresh = datagram.session > session_;
    if (datagram.session < session_ || (!fresh && !has_sender_)) {
      ++statistics_.replayed;
      return false;
    }
    return true;
  }
  if (datagram.sealed) {  // nobody here can say who made it
    ++statistics_.nonsense;
    return false;
  }
  fresh = !has_sender_ || now - heard_at_ > config_.forget;
  if (!fresh && (from_size != sender_size_ || std::memcmp(address, sender_.data(), sender_size_) != 0)) {
    ++statistics_.strangers;
    return false;
  }
  return true;
}

void Receiver::take(const Datagram& datagram, Nanoseconds now) noexcept {
  const auto heard = clock_.hear(clock_memory_, datagram.sent, now);
  if (heard == skinctl::ClockOffset::Heard::refused) {
    ++statistics_.nonsense;
    return;
  }
  if (heard == skinctl::ClockOffset::Heard::leapt) ++statistics_.leaps;
  if (!skinctl::ClockOffset::ready(clock_memory_)) {
    statistics_.untimed += datagram.count();
    return;
  }
  for (std::size_t i = 0; i < datagram.count(); ++i) {
    skinctl::CellSample sample = datagram.sample(i);
    if (!plausible(sample, datagram, config_.oldest)) {
      ++statistics_.bad_samples;
      continue;
    }
    sample.time = skinctl::ClockOffset::stamp(clock_memory_, sample.time);
    samples_.push_back(sample);
    ++statistics_.samples;
  }
}

}  // namespace adapters::skin
