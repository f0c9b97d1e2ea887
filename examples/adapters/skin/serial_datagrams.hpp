// Skin datagrams on a serial line, one after the other: what a home-made pad without a network sends.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>

#include "examples/adapters/skin/datagram.hpp"

namespace adapters::skin {

/// Finds open datagrams of version 3 in the bytes of a line, however they are cut. A header tells where the
/// next one begins; behind damage it is looked for, byte by byte. A datagram has no sum: one counts where its
/// kind is that of the first, and every sample was measured before the sending, at most 10 s before. A
/// reading that damage leaves there is the receiver's to judge, by the ranges of its kind. Lines over USB
/// have no such damage, bare wires do. Allocates nothing.
class SerialDatagrams {
 public:
  struct Counts {
    std::uint64_t datagrams = 0;
    std::uint64_t dropped = 0;  ///< bytes that belong to no datagram
  };

  /// Takes bytes as they came, and calls `f(std::span<const std::uint8_t>)` for each datagram that they end.
  template <class F>
  void take(std::span<const std::uint8_t> bytes, F&& f) {
    for (const std::uint8_t byte : bytes) {
      buffer_[filled_++] = byte;
      while (filled_ > 0) {
        const std::size_t size = expected();
        if (size > filled_) break;
        const bool found = size > 0 && whole(size);
        if (found) f(std::span<const std::uint8_t>(buffer_).first(size));
        (found ? counts_.datagrams : counts_.dropped) += 1;
        const std::size_t done = found ? size : 1;
        std::copy(buffer_.begin() + std::ptrdiff_t(done), buffer_.begin() + std::ptrdiff_t(filled_),
                  buffer_.begin());
        filled_ -= done;
      }
    }
  }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t header = header_size + kind_size;

  [[nodiscard]] unsigned number(std::size_t at) const noexcept {
    return buffer_[at] | unsigned{buffer_[at + 1]} << 8;
  }
  /// Bytes of the datagram that begins the buffer, or of its header; 0: none can.
  [[nodiscard]] std::size_t expected() const noexcept {
    constexpr std::array<std::uint8_t, 6> begin{'S', 'K', 'I', 'N', 3, 0};
    if (!std::equal(begin.begin(), begin.begin() + std::ptrdiff_t(std::min(begin.size(), filled_)),
                    buffer_.begin()))
      return 0;
    if (filled_ < header) return header;
    const std::size_t count = number(6), readings = number(22);
    if (readings < 1 || readings > 32 || count > max_samples(readings)) return 0;
    return header + count * sample_size(readings);
  }
  [[nodiscard]] bool whole(std::size_t size) noexcept {
    Datagram found;
    if (!parse(std::span(buffer_).first(size), found) || found.sealed) return false;
    if (counts_.datagrams > 0 && (found.kind != kind_ || found.readings != readings_)) return false;
    for (std::size_t at = header; at < size; at += found.size_of_sample()) {
      std::uint64_t time = 0;
      for (std::size_t b = 8; b-- > 0;) time = time << 8 | buffer_[at + 4 + b];
      if (!in_time(skinctl::Nanoseconds(static_cast<std::int64_t>(time)), found, std::chrono::seconds(10)))
        return false;
    }
    kind_ = found.kind, readings_ = found.readings;
    return true;
  }

  std::array<std::uint8_t, largest> buffer_{};
  std::size_t filled_ = 0;
  std::uint32_t kind_ = 0;
  std::size_t readings_ = 0;
  Counts counts_;
};

}  // namespace adapters::skin
