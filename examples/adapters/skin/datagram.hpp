// The skin datagram as PROTOCOL.md defines it: from bytes to samples, every byte checked.
#pragma once

#include <cstdint>
#include <span>

#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::skin {

inline constexpr std::size_t header_size = 20, sample_size = 44, max_samples = 33;
inline constexpr std::size_t largest = header_size + max_samples * sample_size;

/// A datagram whose frame is right; its samples are still to be checked one by one.
struct Datagram {
  std::uint32_t sequence = 0;
  skinctl::Nanoseconds sent{};  ///< the sender's clock
  bool sealed = false;          ///< version 2; whether its tag is right is still to be checked
  std::uint64_t session = 0;    ///< of version 2
  std::span<const std::uint8_t> samples;

  [[nodiscard]] std::size_t count() const noexcept { return samples.size() / sample_size; }
  /// Sample `i` < `count()`, times by the sender's clock.
  [[nodiscard]] skinctl::CellSample sample(std::size_t i) const noexcept;
};

/// False for bytes that are no datagram of version 1 or 2: wrong magic, version, count or length.
bool parse(std::span<const std::uint8_t> bytes, Datagram& out) noexcept;

/// Writes a datagram of version 1 with at most `max_samples` samples, whose times and `sent` are of one clock, and
/// returns its size; 0 where the buffer or the number does not allow it.
[[nodiscard]] std::size_t write(std::span<std::uint8_t> buffer, std::uint32_t sequence,
                                skinctl::Nanoseconds sent,
                                std::span<const skinctl::CellSample> samples) noexcept;

/// Whether a sample may be used: finite, in the sensors' ranges, and not from after the time of sending or
/// more than `oldest` before it.
bool plausible(const skinctl::CellSample& sample, const Datagram& datagram,
               skinctl::Nanoseconds oldest) noexcept;

}  // namespace adapters::skin
