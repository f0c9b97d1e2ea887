// The robot's end of the reverse socket: messages of 8 big-endian int32 out of a byte stream.
#pragma once

#include <span>

#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/wire.hpp"

namespace simulated_ur5 {

/// Collects bytes and hands out whole messages.
class ReverseReader {
 public:
  template <class Take>
  void feed(std::span<const std::uint8_t> bytes, Take&& take) {
    for (const std::uint8_t b : bytes) {
      buffer_[size_++] = b;
      if (size_ < reverse_message_size) continue;
      size_ = 0;
      BigEndianReader in(buffer_);
      ReverseMessage m;
      m.read_timeout_ms = in.i32();
      for (std::int32_t& v : m.values) v = in.i32();
      m.mode = in.i32();
      take(m);
    }
  }

 private:
  std::array<std::uint8_t, reverse_message_size> buffer_{};
  std::size_t size_ = 0;
};

}  // namespace simulated_ur5
