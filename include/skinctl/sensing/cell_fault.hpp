// SPDX-License-Identifier: BSD-3-Clause
// The faults of a skin cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The faults of a cell: false readings of touch, or silence.
enum class CellFault : std::uint8_t {
  stuck,       ///< sends one reading again and again; dead where that is 0
  saturated,   ///< reads the top of its range without a touch
  blinking,    ///< jumps between readings
  noisy,       ///< reads far more noise than it should
  cross_talk,  ///< reads a share of what a cell elsewhere feels
  discharge,   ///< rest level that has jumped, as after an electrostatic discharge, and creeps back
  unheard,     ///< samples that come late, or not at all
  quiet        ///< pushes without tremor or other life while the arm gives way: see `LifeSettings`
};
inline constexpr std::size_t cell_faults = 8;

/// The name of a fault in words, for reports: "stuck".
[[nodiscard]] constexpr const char* name(CellFault fault) noexcept {
  constexpr std::array<const char*, cell_faults> names = {"stuck",      "saturated", "blinking", "noisy",
                                                          "cross-talk", "discharge", "unheard",  "quiet"};
  const auto k = static_cast<std::size_t>(fault);
  return k < cell_faults ? names[k] : "unknown";
}

/// A set of faults of one cell.
class CellFaults {
 public:
  constexpr CellFaults() noexcept = default;
  constexpr CellFaults(CellFault fault) noexcept : bits_(bit(fault)) {}  // a fault is the set of itself
  [[nodiscard]] constexpr bool any() const noexcept { return bits_ != 0; }
  [[nodiscard]] constexpr bool has(CellFault fault) const noexcept { return (bits_ & bit(fault)) != 0; }
  constexpr CellFaults& operator|=(CellFaults other) noexcept {
    bits_ = static_cast<std::uint8_t>(bits_ | other.bits_);
    return *this;
  }
  friend constexpr bool operator==(CellFaults, CellFaults) noexcept = default;

 private:
  static constexpr std::uint8_t bit(CellFault fault) noexcept {
    return static_cast<std::uint8_t>(1u << static_cast<unsigned>(fault));
  }
  std::uint8_t bits_ = 0;
};

SKINCTL_END_NAMESPACE
