#include "examples/adapters/skin/tf_luna.hpp"

#include <numeric>

#include "examples/adapters/serial.hpp"

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

TfLunaLine::TfLunaLine(const std::string& device, std::uint32_t cell, unsigned speed)
    : fd_(open_serial(device, speed)), cell_(cell) {}

bool TfLunaLine::read(can::Deadline deadline) noexcept {
  std::array<std::uint8_t, (max_frames - 1) * TfLunaParser::size> bytes;  // no more than there is room for
  for (bool looked = false; count_ == 0 && !closed_; looked = true) {
    if (looked && std::chrono::steady_clock::now() >= deadline) break;  // whatever it floods us with
    std::size_t n = 0;
    const Read read = read_some(fd_, bytes, n, deadline);
    closed_ = read == Read::closed;
    if (read != Read::some) return false;
    parser_.take(std::span(bytes).first(n), [this](const TfLunaFrame& frame) {
      if (!frame.measured()) {
        ++blinded_;
        return;
      }
      samples_[count_++] = {.cell = cell_, .readings = frame.readings(), .measured = 1};
    });
  }
  return count_ > 0;
}

}  // namespace adapters::skin
