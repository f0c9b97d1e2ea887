// TF-Luna: a time-of-flight sensor that writes distances to a serial line (Benewake, SJ-PM-TF-Luna, appendix
// I, "9-byte/cm", which it speaks unasked).
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <utility>

#include "examples/adapters/skin/sensor_line.hpp"

namespace adapters::skin {

/// A beam of 2 degrees as one cell: its frame lies in the window, z looks out. It feels nothing and sees what
/// comes: `near` is 1 up to 0.2 m, where it is blind for anything nearer, and falls to 0 at 1 m.
///
/// What reflects too little to be measured (strength below 100) is not near. Blinded (65535, by the sun or a
/// mirror) it measures nothing, and its cell falls silent: a skin that waits for it stops.
struct TfLuna {
  static constexpr std::string_view name = "tf-luna";
  static constexpr double blind = 0.2, reach = 1.0;  ///< distances at which `near` is 1 and 0 [m]
  static constexpr std::array readings{
      skinctl::Reading{"near", 0, 1}, skinctl::Reading{"distance", 0, 655.35},
      skinctl::Reading{"strength", 0, 65534}, skinctl::Reading{"temperature", -256, 8000}};
  static constexpr std::array channels{skinctl::Channel{"proximity", skinctl::ChannelUse::seen, 0b0001, 1},
                                       skinctl::Channel{"distance", skinctl::ChannelUse::told, 0b0010},
                                       skinctl::Channel{"strength", skinctl::ChannelUse::told, 0b0100},
                                       skinctl::Channel{"temperature", skinctl::ChannelUse::told, 0b1000}};
};

/// What a frame tells.
struct TfLunaFrame {
  static constexpr std::uint16_t weakest = 100, blinded = 65535;
  std::uint16_t centimetres = 0, strength = 0, eighths = 0;  ///< temperature: eighths / 8 - 256 [C]

  /// Whether it is a measurement.
  [[nodiscard]] bool measured() const noexcept { return strength != blinded; }
  /// The numbers of `TfLuna::readings`.
  [[nodiscard]] std::array<float, 4> readings() const noexcept;
  friend bool operator==(const TfLunaFrame&, const TfLunaFrame&) noexcept = default;
};

/// Finds frames in the bytes of a line, however they are cut: 0x59 0x59, three uint16 little-endian, and the
/// low byte of the sum of those eight. Of bytes that damage changed one in 256 sums is right by chance.
class TfLunaParser {
 public:
  static constexpr std::size_t size = 9;                                           ///< bytes of a frame
  static constexpr skinctl::Nanoseconds max_step = std::chrono::milliseconds(10);  ///< between two frames
  struct Counts {
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;  ///< bytes that belong to no frame
  };

  /// Takes bytes as they came, and calls `f(const TfLunaFrame&)` for each frame that they end. Allocates
  /// nothing.
  template <class F>
  void take(std::span<const std::uint8_t> bytes, F&& f) {
    for (const std::uint8_t byte : bytes) {
      buffer_[filled_++] = byte;
      if (filled_ < size) continue;
      TfLunaFrame frame;
      if (whole(frame)) {
        ++counts_.frames, filled_ = 0;
        f(std::as_const(frame));
      } else {
        std::copy(buffer_.begin() + 1, buffer_.end(), buffer_.begin());
        --filled_, ++counts_.dropped;
      }
    }
  }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] bool whole(TfLunaFrame& frame) const noexcept;

  std::array<std::uint8_t, size> buffer_{};
  std::size_t filled_ = 0;
  Counts counts_;
};

/// A sensor at a serial line. A frame is a measurement unless the sensor was blinded.
class TfLunaLine : public SensorLine<TfLuna, TfLunaParser> {
 public:
  using SensorLine::SensorLine;

  /// The measurements that have arrived, see `SensorLine::poll`.
  template <class Now>
  [[nodiscard]] std::span<const Sample> poll(can::Deadline deadline, Now&& now) {
    return SensorLine::poll(deadline, now, [this](const TfLunaFrame& frame, Sample& s) {
      s.readings = frame.readings(), s.measured = 1;
      blinded_ += frame.measured() ? 0u : 1u;
      return frame.measured();
    });
  }
  /// Frames that were none because it was blinded.
  [[nodiscard]] std::uint64_t blinded() const noexcept { return blinded_; }

 private:
  std::uint64_t blinded_ = 0;
};

}  // namespace adapters::skin
