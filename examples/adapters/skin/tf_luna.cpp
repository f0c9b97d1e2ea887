#include "examples/adapters/skin/tf_luna.hpp"

#include <numeric>

namespace adapters::skin {

std::array<float, 4> TfLunaFrame::readings() const noexcept {
  const double distance = 0.01 * centimetres;
  const double near =
      strength < weakest ? 0
                         : std::clamp((TfLuna::reach - distance) / (TfLuna::reach - TfLuna::blind), 0.0, 1.0);
  return {static_cast<float>(near), static_cast<float>(distance), static_cast<float>(strength),
          static_cast<float>(eighths / 8.0 - 256)};
}

bool TfLunaParser::whole(TfLunaFrame& frame) const noexcept {
  if (buffer_[0] != 0x59 || buffer_[1] != 0x59) return false;
  const unsigned sum = std::accumulate(buffer_.begin(), buffer_.end() - 1, 0u);
  if ((sum & 0xffu) != buffer_[size - 1]) return false;
  const auto number = [&](std::size_t at) {
    return static_cast<std::uint16_t>(buffer_[at] | unsigned{buffer_[at + 1]} << 8);
  };
  frame = {number(2), number(4), number(6)};
  return true;
}

}  // namespace adapters::skin
