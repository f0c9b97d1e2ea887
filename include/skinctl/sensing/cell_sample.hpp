// The sample of a skin cell at one time, and its plausibility check.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "skinctl/core/lane.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One message of one cell. Readings of force and proximity are normalised, from 0 (nothing) to 1 (full scale
/// of the sensor); all others are in SI units, along the cell's axes. Cells with fewer sensors leave the
/// missing readings at 0.
struct CellSample {
  Nanoseconds time{};                   ///< time of the measurement
  std::uint32_t cell = 0;               ///< id of the cell
  std::array<float, 3> force{};         ///< three normal forces, each in [0, 1]
  float proximity = 0;                  ///< in [0, 1]
  std::array<float, 3> acceleration{};  ///< proper acceleration [m/s^2]: at rest g, upwards
  float temperature = 0;                ///< [C]
};

namespace detail {
/// The readings in [0, 1] and the other numbers lie side by side, four each, so that a check loads them as
/// they are.
static_assert(std::is_standard_layout_v<CellSample> &&
              offsetof(CellSample, proximity) == offsetof(CellSample, force) + 12 &&
              offsetof(CellSample, acceleration) == offsetof(CellSample, force) + 16 &&
              offsetof(CellSample, temperature) == offsetof(CellSample, force) + 28);

/// Whether a sample passes `check`: all its numbers at once, in registers of eight or four where the target
/// has them. No NaN and no infinity is within bounds.
[[nodiscard]] SKINCTL_INLINE bool believable(const CellSample& s) noexcept {
  constexpr float most = std::numeric_limits<float>::max();
  constexpr float lower[8] = {0, 0, 0, 0, -most, -most, -most, -most};
  constexpr float upper[8] = {1, 1, 1, 1, most, most, most, most};
  if constexpr (native_lanes<float> >= 4) {
    // Without registers this branch is discarded, but still compiled: hence the 1.
    using L = Lane<float, native_lanes<float> >= 4 ? native_lanes<float> : 1>;
    const auto* x =
        reinterpret_cast<const float*>(reinterpret_cast<const char*>(&s) + offsetof(CellSample, force));
    bool good = true;
    for (std::size_t k = 0; k < 8; k += L::lanes) {
      const L n = L::load(x + k);
      good = good & all((n >= L::load(lower + k)) & (n <= L::load(upper + k)));
    }
    return good;
  } else {
    const float x[8] = {s.force[0],        s.force[1],        s.force[2],        s.proximity,
                        s.acceleration[0], s.acceleration[1], s.acceleration[2], s.temperature};
    for (std::size_t k = 0; k < 8; ++k)
      if (!(x[k] >= lower[k] && x[k] <= upper[k])) return false;
    return true;
  }
}
[[nodiscard]] inline bool finite(const CellSample& s) noexcept {
  float none = 0;  // NaN as soon as one of them is not finite
  for (const float x : s.force) none += x - x;
  for (const float x : s.acceleration) none += x - x;
  none += (s.proximity - s.proximity) + (s.temperature - s.temperature);
  return none == 0;
}
}  // namespace detail

/// Empty if the sample is valid; `sample_not_finite` if any field is NaN or infinite (then all fields of the
/// message count as damaged), else `sample_out_of_range` if a force or the proximity is outside [0, 1].
[[nodiscard]] SKINCTL_INLINE Status check(const CellSample& sample) noexcept {
  if (detail::believable(sample)) [[likely]]
    return {};
  return detail::finite(sample) ? Reason::sample_out_of_range : Reason::sample_not_finite;
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
  const float force = (s.force[0] + s.force[1] + s.force[2]) * 16384.0f + 0.5f;
  const float proximity = s.proximity * 65536.0f + 0.5f;
  const auto p = static_cast<std::uint32_t>(proximity);
  return {static_cast<std::uint16_t>(force), static_cast<std::uint16_t>(p < 65535u ? p : 65535u)};
}

SKINCTL_END_NAMESPACE
