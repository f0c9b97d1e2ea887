// The skin datagram as PROTOCOL.md defines it: from bytes to samples, every byte checked.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::skin {

inline constexpr std::size_t largest = 1472;  ///< bytes: one Ethernet frame, never fragmented
inline constexpr std::size_t header_size = 20, kind_size = 8, question_size = 8, tag_size = 16;
/// Bytes before and after the samples of a datagram of version 3, sealed or not: both hold as many.
inline constexpr std::size_t around_samples = header_size + kind_size + question_size + tag_size;

/// Bytes of a sample with `readings` numbers.
[[nodiscard]] constexpr std::size_t sample_size(std::size_t readings) noexcept {
  return 16 + 4 * readings;
}
/// Number of samples that a datagram of version 3 holds: 29 of hexagons, 51 of cells with three readings.
[[nodiscard]] constexpr std::size_t max_samples(std::size_t readings) noexcept {
  return (largest - around_samples) / sample_size(readings);
}
/// A bound on the hexagons of a datagram of any version.
inline constexpr std::size_t most_hexagons = 33;

/// What a receiver asks, and a sealed datagram answers.
using Question = std::array<std::uint8_t, question_size>;

/// A datagram whose frame is right; its samples are still to be checked one by one.
struct Datagram {
  std::uint32_t sequence = 0;
  skinctl::Nanoseconds sent{};  ///< the sender's clock
  std::uint16_t version = 0;    ///< 1 to 3
  bool sealed = false;       ///< version 2, or 3 with a seal; whether its tag is right is still to be checked
  Question question{};       ///< of a sealed one of version 3; in version 2 its session
  std::uint32_t kind = 0;    ///< fingerprint of the kind of sensor
  std::size_t readings = 0;  ///< numbers of a sample
  std::span<const std::uint8_t> samples;

  [[nodiscard]] std::size_t size_of_sample() const noexcept {
    return sample_size(readings) - (version < 3 ? 4 : 0);
  }
  [[nodiscard]] std::size_t count() const noexcept { return samples.size() / size_of_sample(); }
  /// Whether its cells are of this kind.
  template <skinctl::SensorKind Kind>
  [[nodiscard]] bool is() const noexcept {
    using Table = skinctl::KindTable<Kind>;
    return kind == Table::fingerprint() && readings == Table::readings;
  }
  /// Sample `i` < `count()` of a datagram that `is` of this kind; times by the sender's clock.
  template <skinctl::SensorKind Kind>
  [[nodiscard]] skinctl::SampleOf<Kind> sample(std::size_t i) const noexcept {
    skinctl::SampleOf<Kind> s;
    std::array<float, skinctl::KindTable<Kind>::readings> x{};
    read(i, s.time, s.cell, s.measured, s.unrest, x);
    if constexpr (std::is_same_v<Kind, skinctl::Hexagon>) {
      s.force = {x[0], x[1], x[2]}, s.proximity = x[3], s.acceleration = {x[4], x[5], x[6]};
      s.temperature = x[7];
    } else {
      s.readings = x;
    }
    return s;
  }

 private:
  void read(std::size_t i, skinctl::Nanoseconds& time, std::uint32_t& cell, std::uint16_t& measured,
            std::uint16_t& unrest, std::span<float> x) const noexcept;
};

/// False for bytes that are no datagram of version 1, 2 or 3: wrong magic, version, flags, count or length.
bool parse(std::span<const std::uint8_t> bytes, Datagram& out) noexcept;

/// Puts datagrams of version 3 together, sample by sample.
class Writer {
 public:
  /// With a question, room is left for a tag: see `Key::seal`. The buffer has `largest` bytes.
  Writer(std::span<std::uint8_t, largest> buffer, std::uint32_t sequence, skinctl::Nanoseconds sent,
         std::uint32_t kind, std::size_t readings, const Question* question) noexcept;
  /// False, and nothing is added, where the datagram is full.
  bool add(skinctl::Nanoseconds time, std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest,
           std::span<const float> x) noexcept;
  /// Bytes so far, without a tag.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<std::uint8_t, largest> buffer_;
  std::size_t size_, readings_;
  std::uint16_t count_ = 0;
};

/// Writes a datagram of version 3 with the first samples, at most `max_samples`, whose times and `sent` are
/// of one clock, and returns its size.
template <skinctl::SensorKind Kind = skinctl::Hexagon>
std::size_t write(std::span<std::uint8_t, largest> buffer, std::uint32_t sequence, skinctl::Nanoseconds sent,
                  std::span<const skinctl::SampleOf<Kind>> samples,
                  const Question* question = nullptr) noexcept {
  using Table = skinctl::KindTable<Kind>;
  Writer writer(buffer, sequence, sent, Table::fingerprint(), Table::readings, question);
  for (const auto& s : samples)
    if (!writer.add(s.time, s.cell, s.measured, s.unrest, skinctl::detail::readings_of(s))) break;
  return writer.size();
}

/// Whether a sample may be put to use: finite, within its ranges, not measured after the datagram was sent
/// nor more than `oldest` before. Whether its cell exists and has nothing newer, the skin knows.
[[nodiscard]] bool plausible(const skinctl::CellSample& sample, const Datagram& datagram,
                             skinctl::Nanoseconds oldest) noexcept;
[[nodiscard]] bool in_time(skinctl::Nanoseconds time, const Datagram& datagram,
                           skinctl::Nanoseconds oldest) noexcept;
template <skinctl::SensorKind Kind>
[[nodiscard]] bool plausible(const skinctl::SensorSample<Kind>& sample, const Datagram& datagram,
                             skinctl::Nanoseconds oldest) noexcept {
  return !skinctl::check(sample).any() && in_time(sample.time, datagram, oldest);
}

}  // namespace adapters::skin
