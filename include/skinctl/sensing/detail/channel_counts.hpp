// Readings of a kind of sensor as amounts and counts of its channels.
#pragma once

#include "skinctl/core/lane.hpp"
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
  std::size_t r = 0;
  if constexpr (native_lanes<float> >= 4) {
    using L = Lane<float, native_lanes<float> >= 4 ? native_lanes<float> : 1>;
    for (; r + L::lanes <= n; r += L::lanes) {
      const L a = L::load(x + r);
      good = good & all((a >= L::load(bounds[0].data() + r)) & (a <= L::load(bounds[1].data() + r)));
    }
  }
  for (; r < n; ++r) good = good && x[r] >= bounds[0][r] && x[r] <= bounds[1][r];
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
[[nodiscard]] SKINCTL_INLINE constexpr std::uint16_t cut_count_of(float amount) noexcept {
  using Table = KindTable<Kind>;
  constexpr auto limit = static_cast<float>(Table::limit(C)), least = Table::has_cone(C) ? -limit : 0.0f;
  const float steps = amount * static_cast<float>(1 / Table::step(C));
  const float cut = steps > limit ? limit : steps > least ? steps : steps <= least ? least : 0.0f;
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(cut < 0 ? cut - 0.5f : cut + 0.5f));
}
/// The count of an amount that lies within the range of its readings.
template <SensorKind Kind, std::size_t C>
[[nodiscard]] SKINCTL_INLINE constexpr std::uint16_t count_of(float amount) noexcept {
  using Table = KindTable<Kind>;
  if constexpr (Table::has_cone(C) || Table::range(C)[0] < 0 ||
                Table::range(C)[1] > Kind::channels[C].greatest) {
    return cut_count_of<Kind, C>(amount);
  } else {
    const float steps = amount * static_cast<float>(1 / Table::step(C)) + 0.5f;
    constexpr auto limit = static_cast<float>(Table::limit(C));
    if constexpr (Table::range(C)[1] / Table::step(C) > double(limit))
      return static_cast<std::uint16_t>(static_cast<std::int32_t>(steps > limit ? limit : steps));
    return static_cast<std::uint16_t>(static_cast<std::int32_t>(steps));
  }
}
/// The number that a count stands for.
template <SensorKind Kind>
[[nodiscard]] SKINCTL_INLINE constexpr std::int32_t number_of(std::size_t c, std::uint16_t count) noexcept {
  return KindTable<Kind>::has_cone(c) ? static_cast<std::int16_t>(count) : static_cast<std::int32_t>(count);
}

}  // namespace detail

SKINCTL_END_NAMESPACE
