#include "examples/adapters/skin/receiver.hpp"

#include <array>

#include "examples/adapters/socket.hpp"

namespace adapters::skin {

using skinctl::Nanoseconds;
namespace ip = boost::asio::ip;

Receiver::Receiver(const ReceiverConfig& config) : config_(config), socket_(io_), clock_(config.clock) {
  try {
    const ip::udp::endpoint endpoint(ip::make_address(config.address), config.port);
    socket_.open(endpoint.protocol());
    boost::system::error_code ignored;
    socket_.set_option(boost::asio::socket_base::receive_buffer_size(1 << 20), ignored);
    socket_.bind(endpoint);
    socket_.non_blocking(true);
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot receive skin at " + config.address + ":" + std::to_string(config.port) +
                          ": " + e.what());
  }
  samples_.reserve(config.max_samples);
}

std::span<const skinctl::CellSample> Receiver::poll(Nanoseconds now) noexcept {
  samples_.clear();
  std::array<std::uint8_t, largest + 1> bytes;  // one more, to see that a datagram is too long
  // Bounded: a flood cannot keep the loop here.
  for (std::size_t k = 0; k < 4096 && samples_.size() + max_samples <= config_.max_samples; ++k) {
    boost::system::error_code error;
    ip::udp::endpoint from;
    const std::size_t n = socket_.receive_from(boost::asio::buffer(bytes), from, 0, error);
    if (error == boost::asio::error::would_block) break;
    if (error) continue;
    Datagram datagram;
    if (!parse(std::span(bytes).first(n), datagram)) {
      ++statistics_.nonsense;
      continue;
    }
    const bool fresh = !has_sender_ || now - heard_at_ > config_.forget;
    if (!fresh && from != sender_) {
      ++statistics_.strangers;
      continue;
    }
    if (fresh) {
      has_sender_ = true;
      sender_ = from;
      clock_memory_ = {};
    } else {
      const auto step = static_cast<std::int32_t>(datagram.sequence - newest_);
      if (step <= 0) {
        ++statistics_.late;
        continue;
      }
      statistics_.lost += static_cast<std::uint32_t>(step - 1);
    }
    newest_ = datagram.sequence;
    heard_at_ = now;
    ++statistics_.datagrams;
    take(datagram, now);
  }
  return samples_;
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
