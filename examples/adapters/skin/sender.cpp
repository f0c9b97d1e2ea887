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

/// Takes the questions and pictures that have come; the last one counts.
void Sender::listen() noexcept {
  constexpr int most = 16;  // bounded: a flood cannot keep the sender here
  std::array<std::uint8_t, Picture::header + Picture::most / 8 + tag_size + 1> bytes;  // one more: too long
  const Key* const key = key_ ? &*key_ : nullptr;
  for (int k = 0; k < most; ++k) {
    const auto n = ::recv(socket_.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (n < 0) return;
    const auto heard = std::span(bytes).first(static_cast<std::size_t>(n));
    if (key != nullptr && parse_question(heard, *key, question_))
      ++asked_;
    else if (Picture picture; parse_picture(heard, key, picture) && picture.number >= picture_.number)
      picture_ = picture, wants_ = true;
    else
      ++foreign_;
  }
}

void Sender::lights_shown() noexcept {
  if (!wants_) return;
  wants_ = false;
  std::array<std::uint8_t, ShownBytes().size() + tag_size> bytes{};
  const ShownBytes said = shown_datagram(picture_.number);
  std::copy(said.begin(), said.end(), bytes.begin());
  const std::size_t size = key_ ? key_->seal(Sealed::lights, bytes, said.size()) : said.size();
  static_cast<void>(push(std::span(bytes).first(size)));
}

/// Seals and sends what lies in the buffer.
std::size_t Sender::pass_on(std::size_t size) noexcept {
  if (key_) size = key_->seal(Sealed::samples, buffer_, size);
  const bool sent = push(std::span(buffer_).first(size));
  failed_ += sent ? 0u : 1u;
  return sent ? 1 : 0;
}

bool Sender::push(std::span<const std::uint8_t> bytes) noexcept {
  boost::system::error_code error;
  for (int attempt = 0; attempt < 2;
       ++attempt) {  // the first may only tell that an earlier one met a closed port
    socket_.send(boost::asio::buffer(bytes.data(), bytes.size()), 0, error);
    if (error != boost::asio::error::connection_refused) break;
  }
  return !error;
}

}  // namespace adapters::skin
