#include "examples/adapters/skin/any_skin.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace adapters::skin {
namespace {

bool likely(float number, std::size_t k) noexcept {
  const float size = std::abs(number);
  return (size == 0 || size >= 0.01f) && (k % 4 == 0 ? number >= -50 && number <= 150 : size <= 2e5f);
}

}  // namespace

bool AnySkinParser::whole(AnySkinPacket& packet) const noexcept {
  if (buffer_[size - 2] != '\r' || buffer_[size - 1] != '\n' || before_ != end_of_packet) return false;
  for (std::size_t k = 0; k < packet.size(); ++k) {
    std::uint32_t bits = 0;
    for (std::size_t b = 4; b-- > 0;) bits = bits << 8 | buffer_[4 * k + b];
    packet[k] = std::bit_cast<float>(bits);
    if (!likely(packet[k], k)) return false;  // NaN as well
  }
  return true;
}

void AnySkinParser::drop_one() noexcept {
  before_ = {before_[1], buffer_[0]};
  std::copy(buffer_.begin() + 1, buffer_.end(), buffer_.begin());
  --filled_;
  ++counts_.dropped;
  counts_.breaks += broken_ ? 0u : 1u;
  broken_ = true;
}

std::array<std::uint8_t, AnySkinParser::size> any_skin_bytes(const AnySkinPacket& packet) noexcept {
  std::array<std::uint8_t, AnySkinParser::size> out{};
  for (std::size_t k = 0; k < packet.size(); ++k)
    for (std::size_t b = 0; b < 4; ++b)
      out[4 * k + b] = static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(packet[k]) >> (8 * b));
  out[out.size() - 2] = '\r', out[out.size() - 1] = '\n';
  return out;
}

}  // namespace adapters::skin
