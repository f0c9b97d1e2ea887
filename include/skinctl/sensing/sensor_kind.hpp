// SPDX-License-Identifier: BSD-3-Clause
// A kind of sensor as a struct: what its cells read, and the channels in which these readings push.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One number of a sample. A sample with a reading outside of its range is refused.
struct Reading {
  std::string_view name;
  double min = 0, max = 1;  ///< range of the reading, in its unit
  /// Bound of a range that admits any finite number.
  static constexpr double any = std::numeric_limits<float>::max();
};

/// The meaning of a channel's amount to the robot.
enum class ChannelUse : std::uint8_t {
  contact,  ///< the world pushes: a port of energy
  seen,     ///< something at a distance: the controller's own push, which an energy tank pays for
  told      ///< no force: an acceleration, a temperature
};

/// Friction cone: the limit of a channel's amount by the pressure of its own cell.
struct Cone {
  double friction = 0;  ///< largest ratio of the channel's force to the cell's pressure; 0: no limit
};
/// The cone of shear: a cell that nothing presses is not dragged, whatever it reads. With 0.8 a stuck channel
/// pushes 1.6 N beside a pressure of 2 N; a cover that grips harder has a cone of its own.
inline constexpr Cone with_normal{0.8};

/// A sum of readings that acts along one direction at one place of its cell.
///
/// A contact without a cone is a pressure: below 0 it counts as 0, because a cell is pushed and not pulled.
/// One with a cone has a sign. `told` has no direction.
struct Channel {
  std::string_view name;
  ChannelUse use = ChannelUse::contact;
  std::uint32_t readings = 0;  ///< bit r: reading r belongs to the sum
  double greatest = 1;         ///< magnitude at which the sum is cut off, in the readings' unit, > 0
  /// Direction of the force on the cell for a positive amount, along the cell's axes.
  std::array<double, 3> direction{0, 0, -1};
  std::array<double, 3> place{};  ///< point of application, from the cell's origin along its axes [m]
  Cone cone{};
};

/// A kind of sensor: a struct with a `name`, its `readings`, and its `channels`, those that are told last.
///
///     struct Taxel {
///       static constexpr std::string_view name = "taxel-1";
///       static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"y", -20, 20}, Reading{"z", 0, 20}};
///       static constexpr std::array channels{
///           Channel{"normal", ChannelUse::contact, 0b100, 20},
///           Channel{"shear x", ChannelUse::contact, 0b001, 20, {1, 0, 0}, {}, with_normal},
///           Channel{"shear y", ChannelUse::contact, 0b010, 20, {0, 1, 0}, {}, with_normal}};
///     };
template <class K>
concept SensorKind = requires {
  { K::name } -> std::convertible_to<std::string_view>;
  { K::readings[0] } -> std::convertible_to<Reading>;
  { K::channels[0] } -> std::convertible_to<Channel>;
  requires K::readings.size() > 0 && K::readings.size() <= 32;
};

/// Value of `measured` or `unrest` of a cell that does not say it.
inline constexpr std::uint16_t unsaid = 65535;

/// One message of one cell of a kind.
template <SensorKind Kind>
struct SensorSample {
  Nanoseconds time{};      ///< time of the measurement
  std::uint32_t cell = 0;  ///< id of the cell
  std::array<float, Kind::readings.size()> readings{};
  std::uint16_t measured = unsaid, unrest = unsaid;  ///< see `CellSample`
};

namespace detail {

/// The faults of a kind of sensor.
enum class KindFault {
  none,
  pushes_nothing,
  told_first,
  missing_reading,
  no_direction,
  no_amount,
  no_pressure
};

constexpr KindFault kind_fault(std::span<const Channel> channels, std::size_t readings) {
  bool told = false, pushes = false, pressed = false, cone = false;
  for (const Channel& c : channels) {
    const auto& d = c.direction;
    const double off = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1;
    const bool contact = c.use == ChannelUse::contact;
    if (told && c.use != ChannelUse::told) return KindFault::told_first;
    if (c.readings == 0 || (std::uint64_t(c.readings) >> readings) != 0) return KindFault::missing_reading;
    told = c.use == ChannelUse::told;
    if (told) continue;
    if (!(off < 1e-9 && off > -1e-9)) return KindFault::no_direction;
    if (!(c.greatest > 1e-6 && c.greatest < 1e6)) return KindFault::no_amount;
    if (c.cone.friction < 0 || (c.cone.friction > 0 && !contact)) return KindFault::no_pressure;
    pushes = true, pressed = pressed || (contact && !(c.cone.friction > 0)),
    cone = cone || c.cone.friction > 0;
  }
  if (!pushes) return KindFault::pushes_nothing;
  return cone && !pressed ? KindFault::no_pressure : KindFault::none;
}

/// True for a kind without fault; any other does not compile, and the error names the fault.
template <class Kind>
constexpr bool is_sound() {
  constexpr KindFault fault = kind_fault(Kind::channels, Kind::readings.size());
  static_assert(fault != KindFault::pushes_nothing, "a kind of sensor has a channel that pushes");
  static_assert(fault != KindFault::told_first, "channels that are told stand behind those that push");
  static_assert(fault != KindFault::missing_reading,
                "a channel is a sum of its kind's readings: bit r is reading r");
  static_assert(fault != KindFault::no_direction, "the direction of a channel has unit length");
  static_assert(fault != KindFault::no_amount, "the greatest amount of a channel lies between 1e-6 and 1e6");
  static_assert(fault != KindFault::no_pressure,
                "a cone is that of a contact, beside a pressure of the same kind");
  return fault == KindFault::none;
}

}  // namespace detail

/// Numbers derived from a kind.
template <SensorKind Kind>
struct KindTable {
  static constexpr std::size_t readings = Kind::readings.size(), channels = Kind::channels.size();
  static constexpr bool pushes(std::size_t c) { return Kind::channels[c].use != ChannelUse::told; }
  static constexpr bool is_seen(std::size_t c) { return Kind::channels[c].use == ChannelUse::seen; }
  /// Whether a channel counts only beside the pressure of its cell.
  static constexpr bool has_cone(std::size_t c) { return Kind::channels[c].cone.friction > 0; }
  static constexpr bool is_pressure(std::size_t c) {
    return Kind::channels[c].use == ChannelUse::contact && !has_cone(c);
  }
  /// Number of channels among the first `of` for which `is` is true.
  static constexpr std::size_t count(bool (*is)(std::size_t), std::size_t of) {
    std::size_t n = 0;
    for (std::size_t c = 0; c < of; ++c) n += is(c) ? 1u : 0u;
    return n;
  }
  /// Number of channels that push, the first ones; of pressures; of channels with a cone.
  static constexpr std::size_t pushing = count(pushes, channels);
  static constexpr std::size_t pressures = count(is_pressure, pushing), cones = count(has_cone, pushing);
  static constexpr bool sees = count(is_seen, pushing) > 0;
  /// The readings of all pressures, a bit each.
  static constexpr std::uint32_t pressed_readings = [] {
    std::uint32_t bits = 0;
    for (std::size_t c = 0; c < pushing; ++c) bits |= is_pressure(c) ? Kind::channels[c].readings : 0u;
    return bits;
  }();
  /// The greatest maximum of a channel's readings; a step of a sensor is a share of it.
  static constexpr double full(std::size_t c) {
    double most = 0;
    for (std::size_t r = 0; r < readings; ++r)
      if (((Kind::channels[c].readings >> r) & 1u) && Kind::readings[r].max > most)
        most = Kind::readings[r].max;
    return most;
  }
  /// Index of each channel's unit wrench, in the order of first use: channels that act along one line share
  /// one.
  static constexpr std::array<std::size_t, pushing> line = [] {
    std::array<std::size_t, pushing> out{};
    std::size_t lines = 0;
    for (std::size_t c = 0; c < pushing; ++c) {
      out[c] = lines;
      for (std::size_t b = c; b-- > 0;)
        if (Kind::channels[b].direction == Kind::channels[c].direction &&
            Kind::channels[b].place == Kind::channels[c].place)
          out[c] = out[b];
      if (out[c] == lines) ++lines;
    }
    return out;
  }();
  static constexpr std::size_t lines = [] {
    std::size_t n = 0;
    for (const std::size_t l : line) n = l + 1 > n ? l + 1 : n;
    return n;
  }();
  /// A step of a channel's count, in its unit: the smallest power of two of which 2^16 reach the greatest
  /// amount, 2^15 with a sign.
  static constexpr double step(std::size_t c) {
    double unit = 0x1p-40;
    while (unit * (has_cone(c) ? 32768 : 65536) < Kind::channels[c].greatest) unit *= 2;
    return unit;
  }
  /// The greatest count of a channel.
  static constexpr std::int32_t limit(std::size_t c) {
    const double steps = Kind::channels[c].greatest / step(c) + 0.5;
    const std::int32_t most = has_cone(c) ? 32767 : 65535;
    return steps < most ? static_cast<std::int32_t>(steps) : most;
  }
  /// The least and greatest amounts of a channel that the ranges of its readings allow.
  static constexpr std::array<double, 2> range(std::size_t c) {
    std::array<double, 2> sum{};
    for (std::size_t r = 0; r < readings; ++r)
      if ((Kind::channels[c].readings >> r) & 1u)
        sum[0] += Kind::readings[r].min, sum[1] += Kind::readings[r].max;
    return sum;
  }
  /// A number that tells kinds apart: of name, readings and their ranges (FNV-1a).
  static constexpr std::uint32_t fingerprint() {
    std::uint32_t hash = 2166136261u;
    const auto mix = [&](std::string_view text) {
      for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
      hash = (hash ^ 0xFFu) * 16777619u;
    };
    mix(Kind::name);
    for (const Reading& r : Kind::readings) {
      mix(r.name);
      for (const double x : {r.min, r.max}) {
        const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(x));
        for (int k = 0; k < 32; k += 8) hash = (hash ^ ((bits >> k) & 0xFFu)) * 16777619u;
      }
    }
    return hash;
  }
};

/// Counts of a cell: of each channel that pushes its amount in steps, as an integer whose sums are exact in
/// any order.
template <SensorKind Kind>
struct ChannelCounts {
  /// Amount of each channel [steps]; with a sign (two's complement) where there is a cone.
  std::array<std::uint16_t, KindTable<Kind>::pushing> channel{};
  friend constexpr bool operator==(const ChannelCounts&, const ChannelCounts&) noexcept = default;
};

SKINCTL_END_NAMESPACE
