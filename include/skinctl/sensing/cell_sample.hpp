// SPDX-License-Identifier: BSD-3-Clause
// The hexagonal cell of TUM: its sample at one time, its kind, and its plausibility check.
#pragma once

#include <bit>
#include <type_traits>

#include "skinctl/sensing/detail/channel_counts.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One message of one cell. Readings of force and proximity are normalised, from 0 (nothing) to 1 (full scale
/// of the sensor); all others are in SI units, along the cell's axes. Cells with fewer sensors leave the
/// missing readings at 0.
struct CellSample {
  Nanoseconds time{};                   ///< time of the measurement
  std::uint32_t cell = 0;               ///< id of the cell
  std::array<float, 3> force{};         ///< three normal forces, each in [0, 1]
  float proximity = 0;                  ///< proximity reading, in [0, 1]
  std::array<float, 3> acceleration{};  ///< proper acceleration [m/s^2]: at rest g, upwards
  float temperature = 0;                ///< temperature [C]
  std::uint16_t measured = unsaid;      ///< measurements since the last message of this cell; 0: old readings
  std::uint16_t unrest =
      unsaid;  ///< mean square of the change from measurement to measurement [1/256 step^2]
};

/// The kind of TUM's hexagonal cells: that of a skin which names no other kind.
struct Hexagon {
  static constexpr std::string_view name = "tum-hexagon";
  static constexpr std::array readings{Reading{"force 1"},
                                       Reading{"force 2"},
                                       Reading{"force 3"},
                                       Reading{"proximity"},
                                       Reading{"acceleration x", -Reading::any, Reading::any},
                                       Reading{"acceleration y", -Reading::any, Reading::any},
                                       Reading{"acceleration z", -Reading::any, Reading::any},
                                       Reading{"temperature", -Reading::any, Reading::any}};
  static constexpr std::array channels{Channel{"force", ChannelUse::contact, 0b111, 3},
                                       Channel{"proximity", ChannelUse::seen, 0b1000, 1},
                                       Channel{"acceleration x", ChannelUse::told, 0b10000},
                                       Channel{"acceleration y", ChannelUse::told, 0b100000},
                                       Channel{"acceleration z", ChannelUse::told, 0b1000000},
                                       Channel{"temperature", ChannelUse::told, 0b10000000}};
};

namespace detail {
/// The readings lie side by side.
static_assert(std::is_standard_layout_v<CellSample> && sizeof(CellSample) == 48 &&
              offsetof(CellSample, proximity) == offsetof(CellSample, force) + 12 &&
              offsetof(CellSample, acceleration) == offsetof(CellSample, force) + 16 &&
              offsetof(CellSample, temperature) == offsetof(CellSample, force) + 28);

[[nodiscard]] SKINCTL_INLINE constexpr std::array<float, 8> readings_of(const CellSample& s) noexcept {
  return {s.force[0],        s.force[1],        s.force[2],        s.proximity,
          s.acceleration[0], s.acceleration[1], s.acceleration[2], s.temperature};
}
[[nodiscard]] SKINCTL_INLINE bool believable(const CellSample& s) noexcept {
  return within_ranges<Hexagon>(
      reinterpret_cast<const float*>(reinterpret_cast<const char*>(&s) + offsetof(CellSample, force)));
}
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE bool believable(const SensorSample<Kind>& s) noexcept {
  return within_ranges<Kind>(s.readings.data());
}
}  // namespace detail

/// Empty if the sample is valid; `sample_not_finite` if any field is NaN or infinite (then all fields of the
/// message count as damaged), else `sample_out_of_range` if a force or the proximity is outside [0, 1].
[[nodiscard]] SKINCTL_INLINE Status check(const CellSample& sample) noexcept {
  if (detail::believable(sample)) [[likely]]
    return {};
  float none = 0;  // NaN as soon as one of them is not finite
  for (const float x : detail::readings_of(sample)) none += x - x;
  return none == 0 ? Reason::sample_out_of_range : Reason::sample_not_finite;
}

/// Empty if a sample is valid; `sample_not_finite` if any reading is NaN or infinite, else
/// `sample_out_of_range` if one lies outside of the range that its kind states.
template <SensorKind Kind>
[[nodiscard]] Status check(const SensorSample<Kind>& sample) noexcept {
  if (detail::within_ranges<Kind>(sample.readings.data())) [[likely]]
    return {};
  float none = 0;
  for (const float x : sample.readings) none += x - x;
  return none == 0 ? Reason::sample_out_of_range : Reason::sample_not_finite;
}

/// The readings of a sample as integers, whose sums are exact in any order: the sum of the three forces in
/// steps of 2^-14, the proximity in steps of 2^-16. A force sensor with 1024 steps loses nothing; a proximity
/// of exactly 1 becomes 1 - 2^-16.
struct CellCounts {
  std::uint16_t force = 0;
  std::uint16_t proximity = 0;

  static constexpr double force_unit = 1.0 / 16384;
  static constexpr double proximity_unit = 1.0 / 65536;

  friend constexpr bool operator==(const CellCounts&, const CellCounts&) noexcept = default;
};

/// The counts of a sample that passed `check`.
[[nodiscard]] SKINCTL_INLINE constexpr CellCounts counts(const CellSample& s) noexcept {
  const std::array<float, 8> x = detail::readings_of(s);
  return {detail::count_of<Hexagon, 0>(detail::amount_of<Hexagon, 0>(x.data())),
          detail::count_of<Hexagon, 1>(detail::amount_of<Hexagon, 1>(x.data()))};
}
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE constexpr ChannelCounts<Kind> counts(const SensorSample<Kind>& s) noexcept {
  return [&]<std::size_t... C>(std::index_sequence<C...>) {
    return ChannelCounts<Kind>{{detail::count_of<Kind, C>(detail::amount_of<Kind, C>(s.readings.data()))...}};
  }(std::make_index_sequence<KindTable<Kind>::pushing>{});
}

/// The type of a kind's samples, and that of its counts.
template <SensorKind Kind>
using SampleOf = std::conditional_t<std::is_same_v<Kind, Hexagon>, CellSample, SensorSample<Kind>>;
template <SensorKind Kind>
using CountsOf = std::conditional_t<std::is_same_v<Kind, Hexagon>, CellCounts, ChannelCounts<Kind>>;

/// The amount of a channel of a sample, one that is told too: `amount<Uskin>(sample, 3)`. 0 for a channel
/// that the kind does not have.
template <SensorKind Kind>
[[nodiscard]] constexpr float amount(const SampleOf<Kind>& sample, std::size_t channel) noexcept {
  const auto x = detail::readings_of(sample);
  float sum = 0;
  if (channel < Kind::channels.size())
    for (std::size_t r = 0; r < x.size(); ++r)
      if ((Kind::channels[channel].readings >> r) & 1u) sum += x[r];
  return sum;
}

SKINCTL_END_NAMESPACE
