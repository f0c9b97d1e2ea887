// A frame of a CAN bus.
#pragma once

#include <array>
#include <cstdint>

namespace adapters::can {

/// One classic CAN frame with an 11-bit id.
struct Frame {
  std::uint16_t id = 0;
  bool remote = false;    ///< a request without data
  std::uint8_t size = 0;  ///< 0 to 8
  std::array<std::uint8_t, 8> data{};
  friend bool operator==(const Frame&, const Frame&) = default;
};

}  // namespace adapters::can
