// SPDX-License-Identifier: BSD-3-Clause
// Readings of a kind of sensor as amounts and counts of its channels.
#pragma once

#include "skinctl/core/status.hpp"
#include "skinctl/sensing/sensor_kind.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// All readings of a sample of a kind.
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE constexpr const auto& readings_of(const SensorSample<Kind>& s) noexcept {
  return s.readings;
}

/// Whether all readings lie within the ranges of a kind. No NaN and no infinity does.
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE bool within_ranges(const float* x) noexcept {
  constexpr std::size_t n = KindTable<Kind>::readings;
  static constexpr auto bounds = [] {
    std::array<std::array<float, n>, 2> b{};
    for (std::size_t r = 0; r < n; ++r)
      b[0][r] = static_cast<float>(Kind::readings[r].min),
      b[1][r] = static_cast<float>(Kind::readings[r].max);
    return b;
  }();
  bool good = true;
  for (std::size_t r = 0; r < n; ++r) good = good && x[r] >= bounds[0][r] && x[r] <= bounds[1][r];
  return good;
}

/// The amount of channel `c`: the sum of its readings.
template <SensorKind Kind, std::size_t C>
[[nodiscard]] SKINCTL_INLINE constexpr float amount_of(const float* x) noexcept {
  constexpr std::uint32_t mask = Kind::channels[C].readings;
  float sum = 0;
  bool first = true;
  for (std::size_t r = 0; r < KindTable<Kind>::readings; ++r)
    if ((mask >> r) & 1u) sum = first ? x[r] : sum + x[r], first = false;
  return sum;
}
/// The count of an amount of any size; 0 for NaN.
template <SensorKind Kind, std::size_t C>
[[nodiscard]] SKINCTL_INLINE constexpr std::uint16_t count_of(float amount) noexcept {
  using Table = KindTable<Kind>;
  constexpr auto limit = static_cast<float>(Table::limit(C)), least = Table::has_cone(C) ? -limit : 0.0f;
  const float steps = amount * static_cast<float>(1 / Table::step(C));
  const float cut = steps > limit ? limit : steps > least ? steps : steps <= least ? least : 0.0f;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(cut < 0 ? cut - 0.5f : cut + 0.5f));
}
/// The number that a count of a channel stands for.
template <SensorKind Kind, std::size_t C>
[[nodiscard]] SKINCTL_INLINE constexpr std::int32_t number_of(std::uint16_t count) noexcept {
  if constexpr (KindTable<Kind>::has_cone(C)) {
    return static_cast<std::int16_t>(count);
  } else {
    return count;
  }
}
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE constexpr std::int32_t number_of(std::size_t c, std::uint16_t count) noexcept {
  return KindTable<Kind>::has_cone(c) ? static_cast<std::int16_t>(count) : static_cast<std::int32_t>(count);
}

}  // namespace detail

SKINCTL_END_NAMESPACE
