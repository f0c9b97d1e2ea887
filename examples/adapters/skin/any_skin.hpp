// AnySkin and ReSkin: five magnetometers under a magnetic skin, as a microcontroller writes them to a serial
// line.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <utility>

#include "examples/adapters/skin/sensor_line.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace adapters::skin {

/// A pad of five magnetometers as one cell: its frame lies at the middle chip, z is the outward normal, and x
/// and y are those that its calibration was found in. Readings are as the wire has them, chip after chip:
/// temperature [C], then the field along the chip's own axes [uT]. In the published sketch (gain 7,
/// resolution 0) a chip tells at most 9.7 mT.
///
/// A field is no force. The sums that the kind states are there for its watches (a frozen pad has no unrest);
/// forces come from a `ChannelCalibration`, see `FrontEnd`: give a skin of pads none without
/// `calibrated(skin, ...)`.
struct AnySkin {
  static constexpr std::size_t chips = 5;
  static constexpr double max_field = 10'000;  ///< [uT]
  static constexpr std::string_view name = "anyskin-5";
  static constexpr skinctl::Reading t{"temperature", -50, 150}, x{"field x", -max_field, max_field},
      y{"field y", -max_field, max_field}, z{"field z", -max_field, max_field};
  static constexpr std::array readings{t, x, y, z, t, x, y, z, t, x, y, z, t, x, y, z, t, x, y, z};
  static constexpr std::uint32_t fields = 0b1110'1110'1110'1110'1110,
                                 temperatures = 0b0001'0001'0001'0001'0001;
  static constexpr std::array channels{
      skinctl::Channel{"normal", skinctl::ChannelUse::contact, fields, 20},
      skinctl::Channel{
          "shear x", skinctl::ChannelUse::contact, fields, 20, {1, 0, 0}, {}, skinctl::with_normal},
      skinctl::Channel{
          "shear y", skinctl::ChannelUse::contact, fields, 20, {0, 1, 0}, {}, skinctl::with_normal},
      skinctl::Channel{"temperature 1", skinctl::ChannelUse::told, 1u << 0},
      skinctl::Channel{"temperature 2", skinctl::ChannelUse::told, 1u << 4},
      skinctl::Channel{"temperature 3", skinctl::ChannelUse::told, 1u << 8},
      skinctl::Channel{"temperature 4", skinctl::ChannelUse::told, 1u << 12},
      skinctl::Channel{"temperature 5", skinctl::ChannelUse::told, 1u << 16}};
};

/// The numbers of a packet, in the order of the wire and of `AnySkin::readings`.
using AnySkinPacket = std::array<float, 4 * AnySkin::chips>;

/// Finds packets in the bytes of a line, however they are cut: 20 float32 little-endian and "\r\n", 82 bytes.
///
/// The wire has no counter and no checksum, and "\r\n" may be data. A packet counts where its end stands, the
/// end of another stands before it (or the line begins there), and its numbers can be those of magnetometers:
/// finite, 0 or at least 0.01 in size, temperatures of -50 to 150 C, fields up to 200 mT. A frame that begins
/// elsewhere holds the packet's own "\r\n" within its numbers: as a field of 7e-33 uT, or it shifts the rest
/// so that exponents are others' mantissas. Bytes before a packet are dropped one by one, and counted. Not
/// seen: a number that damage leaves likely, packets lost as a whole, and the seam where the first half of
/// one packet meets the second of another.
class AnySkinParser {
 public:
  static constexpr std::size_t size = 4 * 4 * AnySkin::chips + 2;  ///< bytes of a packet
  static constexpr std::array<std::uint8_t, 2> end_of_packet{'\r', '\n'};
  static constexpr skinctl::Nanoseconds max_step = std::chrono::milliseconds(7);  ///< between two packets
  struct Counts {
    std::uint64_t packets = 0;
    std::uint64_t dropped = 0;  ///< bytes that belong to no packet
    std::uint64_t breaks = 0;   ///< places at which bytes were dropped: damage, or the first of a line
  };

  /// Takes bytes as they came, and calls `f(const AnySkinPacket&)` for each packet that they end. Allocates
  /// nothing.
  template <class F>
  void take(std::span<const std::uint8_t> bytes, F&& f) {
    for (const std::uint8_t byte : bytes) {
      buffer_[filled_++] = byte;
      if (filled_ < size) continue;
      AnySkinPacket packet;
      if (whole(packet)) {
        ++counts_.packets, filled_ = 0, broken_ = false, before_ = end_of_packet;
        f(std::as_const(packet));
      } else {
        drop_one();
      }
    }
  }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] bool whole(AnySkinPacket& packet) const noexcept;
  void drop_one() noexcept;

  std::array<std::uint8_t, size> buffer_{};
  std::size_t filled_ = 0;
  std::array<std::uint8_t, 2> before_ = end_of_packet;  ///< the two bytes before those in the buffer
  bool broken_ = false;
  Counts counts_;
};

/// The bytes of a packet, for simulations.
[[nodiscard]] std::array<std::uint8_t, AnySkinParser::size> any_skin_bytes(
    const AnySkinPacket& packet) noexcept;

/// A pad at a serial line. Each packet is a measurement. `unrest` is in steps of 1/6 uT, about one of the
/// chip's.
class AnySkinLine : public SensorLine<AnySkin, AnySkinParser> {
 public:
  using SensorLine::SensorLine;

  /// The packets that have arrived, see `SensorLine::poll`.
  template <class Now>
  [[nodiscard]] std::span<const Sample> poll(can::Deadline deadline, Now&& now) {
    return SensorLine::poll(deadline, now, [this](const AnySkinPacket& packet, Sample& s) {
      s.readings = packet;
      unrest_.measure(memory_, s), unrest_.tell(memory_, s);
      return true;
    });
  }

 private:
  skinctl::Unrest<AnySkin> unrest_{1.0 / 60000};
  skinctl::Unrest<AnySkin>::Memory memory_;
};

}  // namespace adapters::skin
