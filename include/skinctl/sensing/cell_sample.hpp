// The sample of a skin cell at one time, and its plausibility check.
#pragma once

#include <array>
#include <cstdint>

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
/// The four readings and the four other numbers of a sample.
struct CellNumbers {
  std::array<float, 4> readings, others;
};
SKINCTL_INLINE constexpr CellNumbers numbers(const CellSample& s) noexcept {
  return {{s.force[0], s.force[1], s.force[2], s.proximity},
          {s.acceleration[0], s.acceleration[1], s.acceleration[2], s.temperature}};
}
SKINCTL_INLINE constexpr bool within_range(const std::array<float, 4>& x) noexcept {
  return x[0] >= 0 && x[0] <= 1 && x[1] >= 0 && x[1] <= 1 && x[2] >= 0 && x[2] <= 1 && x[3] >= 0 && x[3] <= 1;
}
SKINCTL_INLINE constexpr bool finite(const std::array<float, 4>& x) noexcept {
  return x[0] - x[0] == 0 && x[1] - x[1] == 0 && x[2] - x[2] == 0 && x[3] - x[3] == 0;
}
/// Checks finiteness and ranges together, in registers of four where the target has them.
SKINCTL_INLINE bool believable(const CellNumbers& n) noexcept {
  if constexpr (native_lanes<float> >= 4) {
    // Without registers this branch is discarded, but still compiled: hence the 1.
    using L = Lane<float, native_lanes<float> >= 4 ? 4 : 1>;
    const L x = L::load(n.readings.data()), y = L::load(n.others.data());
    return all((x >= L(0.0f)) & (x <= L(1.0f)) & (y - y == L(0.0f)));
  } else {
    return within_range(n.readings) && finite(n.others);
  }
}
}  // namespace detail

/// Empty if the sample is valid; `sample_not_finite` if any field is NaN or infinite (then all fields of the
/// message count as damaged), else `sample_out_of_range` if a force or the proximity is outside [0, 1].
[[nodiscard]] SKINCTL_INLINE Status check(const CellSample& sample) noexcept {
  const detail::CellNumbers n = detail::numbers(sample);
  if (detail::believable(n)) [[likely]]
    return {};
  return detail::finite(n.readings) && detail::finite(n.others) ? Reason::sample_out_of_range
                                                                : Reason::sample_not_finite;
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
