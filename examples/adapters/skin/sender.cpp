#include "examples/adapters/skin/sender.hpp"

#include <algorithm>

#include "examples/adapters/socket.hpp"

namespace adapters::skin {

Sender::Sender(const std::string& host, std::uint16_t port, std::optional<Key> key)
    : socket_(io_), key_(std::move(key)), session_(session_now()) {
  try {
    const boost::asio::ip::udp::endpoint to(boost::asio::ip::make_address(host), port);
    socket_.open(to.protocol());
    socket_.connect(to);
    socket_.non_blocking(true);
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot send skin to " + host + ":" + std::to_string(port) + ": " + e.what());
  }
}

std::size_t Sender::send(std::span<const skinctl::CellSample> samples, skinctl::Nanoseconds now) noexcept {
  std::size_t sent = 0;
  const std::size_t most = key_ ? max_sealed_samples : max_samples;
  do {
    const auto some = samples.first(std::min(samples.size(), most));
    samples = samples.subspan(some.size());
    std::size_t size = write(buffer_, sequence_, now, some);
    if (key_) size = seal(buffer_, size, session_, *key_);
    if (++sequence_ == 0) session_ = session_now();
    boost::system::error_code error;
    socket_.send(boost::asio::buffer(buffer_.data(), size), 0, error);
    (error ? failed_ : sent) += 1;
  } while (!samples.empty());
  return sent;
}

}  // namespace adapters::skin
