#include "examples/adapters/skin/sender.hpp"

#include <sys/socket.h>

#include <algorithm>

#include "examples/adapters/socket.hpp"

namespace adapters::skin {

Sender::Sender(const std::string& host, std::uint16_t port, std::optional<Key> key)
    : socket_(io_), key_(std::move(key)) {
  try {
    const boost::asio::ip::udp::endpoint to(boost::asio::ip::make_address(host), port);
    socket_.open(to.protocol());
    socket_.connect(to);
    socket_.non_blocking(true);
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot send skin to " + host + ":" + std::to_string(port) + ": " + e.what());
  }
}

/// Takes the questions that have come; the last one counts.
void Sender::listen() noexcept {
  constexpr int most = 16;                                     // bounded: a flood cannot keep the sender here
  std::array<std::uint8_t, QuestionBytes().size() + 1> bytes;  // one more, to see that one is too long
  for (int k = 0; key_ && k < most; ++k) {
    const auto n = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (n < 0) return;
    (parse_question(std::span(bytes).first(static_cast<std::size_t>(n)), *key_, question_) ? asked_
                                                                                           : foreign_) += 1;
  }
}

/// Seals and sends what lies in the buffer.
std::size_t Sender::pass_on(std::size_t size) noexcept {
  if (key_) size = key_->seal(Sealed::samples, buffer_, size);
  boost::system::error_code error;
  for (int attempt = 0; attempt < 2;
       ++attempt) {  // the first may only tell that an earlier one met a closed port
    socket_.send(boost::asio::buffer(buffer_.data(), size), 0, error);
    if (error != boost::asio::error::connection_refused) break;
  }
  failed_ += error ? 1u : 0u;
  return error ? 0 : 1;
}

}  // namespace adapters::skin
