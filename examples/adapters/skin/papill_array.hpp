// PapillArray (PTS 2.0): sensors of soft pillars that tell force and deflection, at a controller's serial
// line.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "examples/adapters/can/link.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace adapters::skin {

/// A pillar as one cell: force [N] along x, y and z of its sensor, and the deflection of its tip [mm], which
/// is told. z > 0 for a push is assumed: try it before a robot does. Zero is where the controller's bias was
/// taken.
struct PapillArray {
  static constexpr std::string_view name = "papill-array";
  static constexpr std::array readings{
      skinctl::Reading{"force x", -50, 50},      skinctl::Reading{"force y", -50, 50},
      skinctl::Reading{"force z", -50, 50},      skinctl::Reading{"deflection x", -50, 50},
      skinctl::Reading{"deflection y", -50, 50}, skinctl::Reading{"deflection z", -50, 50}};
  static constexpr std::array channels{
      skinctl::Channel{"normal", skinctl::ChannelUse::contact, 0b100, 50},
      skinctl::Channel{
          "shear x", skinctl::ChannelUse::contact, 0b001, 50, {1, 0, 0}, {}, skinctl::with_normal},
      skinctl::Channel{
          "shear y", skinctl::ChannelUse::contact, 0b010, 50, {0, 1, 0}, {}, skinctl::with_normal},
      skinctl::Channel{"deflection x", skinctl::ChannelUse::told, 0b001000},
      skinctl::Channel{"deflection y", skinctl::ChannelUse::told, 0b010000},
      skinctl::Channel{"deflection z", skinctl::ChannelUse::told, 0b100000}};
};

/// What a controller tells at one time.
struct PapillArrayPacket {
  static constexpr std::size_t max_sensors = 4, max_pillars = 100;
  using Pillar = std::array<float, 6>;  ///< readings of a `PapillArray`
  struct Sensor {
    std::size_t pillars = 0;
    std::array<Pillar, max_pillars> pillar{};
    bool has_whole = false;
    std::array<float, 6> whole{};  ///< force [N] and torque [N mm] of the sensor as a whole
  };
  std::uint32_t number = 0;        ///< one more than in the packet before
  std::uint64_t microseconds = 0;  ///< of the controller's clock
  std::size_t sensors = 0;
  std::array<Sensor, max_sensors> sensor{};
};
/// Id of pillar 0, 1 ... of sensor 0, 1 ... of a controller.
[[nodiscard]] constexpr std::uint32_t papill_array_cell(std::size_t sensor, std::size_t pillar) noexcept {
  return static_cast<std::uint32_t>(128 * sensor + pillar);
}

/// Reads what stands between the marks of a packet, its sum included: an index of blocks (1 the counter and
/// the time, 3 the pillars, 4 the sensors as a whole; others are left alone) and the blocks, whose parts
/// follow each other. False for a wrong sum, for a block that is missing (1 and 3), given twice or reaches
/// beyond the sum, for bytes behind the last block, and for more sensors or pillars than a controller has.
[[nodiscard]] bool parse_papill_array(std::span<const std::uint8_t> bytes, PapillArrayPacket& out) noexcept;

/// Finds packets in the bytes of a line, however they are cut: from 55 66 77 88 to aa bb cc dd. Both marks
/// may be data: whenever an end mark has come, each start before it within `largest` bytes is tried, the
/// latest first, and the 16-bit sum of all bytes decides, and whether the blocks make sense. Bytes that
/// belong to no packet are counted. Allocates nothing.
class PapillArrayParser {
 public:
  static constexpr std::size_t largest = 2048;  ///< bytes of a packet, marks included
  struct Counts {
    std::uint64_t packets = 0;
    std::uint64_t dropped = 0;  ///< bytes that belong to no packet
  };

  /// Takes a byte; true: it ended the packet that `packet` holds until the next call.
  bool take(std::uint8_t byte) noexcept;
  [[nodiscard]] const PapillArrayPacket& packet() const noexcept { return packet_; }
  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }

 private:
  bool try_starts() noexcept;

  std::array<std::uint8_t, 2 * largest> buffer_{};
  std::array<std::uint16_t, 2 * largest + 1> sum_{};  ///< of the bytes before each
  std::array<std::uint16_t, largest / 2> starts_{};   ///< of packets, in the buffer
  std::size_t filled_ = 0, started_ = 0;
  PapillArrayPacket packet_;
  Counts counts_;
};

/// The bytes of a packet, marks included, for simulations.
[[nodiscard]] std::vector<std::uint8_t> papill_array_bytes(const PapillArrayPacket& packet);

/// Makes samples out of packets. Each packet is a measurement of all pillars.
class PapillArraySamples {
 public:
  using Sample = skinctl::SensorSample<PapillArray>;
  /// The pillars of a packet, all stamped `time`. Until the next call.
  [[nodiscard]] std::span<const Sample> of(const PapillArrayPacket& packet, skinctl::Nanoseconds time);

 private:
  skinctl::Unrest<PapillArray> unrest_{1.0 / 60000};
  std::array<skinctl::Unrest<PapillArray>::Memory, 128 * PapillArrayPacket::max_sensors> pillars_{};
  std::vector<Sample> samples_;
};

/// A controller at a serial line.
class PapillArrayLine {
 public:
  /// Opens `device` and asks for `rate` packets a second: 100, 250, 500 or 1000. With `bias` it also asks for
  /// a new zero, for which nothing may touch the sensors for 2 s. Throws `ConnectionError` where `device` is
  /// no serial line or takes nothing, `ConfigurationError` for another rate.
  explicit PapillArrayLine(const std::string& device, unsigned rate = 500, bool bias = false);

  /// The next packet, waiting for it until `deadline`; nothing: there is none yet, or the line is closed.
  [[nodiscard]] const PapillArrayPacket* next(can::Deadline deadline) noexcept;
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] const PapillArrayParser::Counts& counts() const noexcept { return parser_.counts(); }

 private:
  can::Descriptor fd_;
  PapillArrayParser parser_;
  std::array<std::uint8_t, 1024> bytes_{};
  std::size_t at_ = 0, end_ = 0;
  bool closed_ = false;
};

}  // namespace adapters::skin
