// SPDX-License-Identifier: BSD-3-Clause
// The stages of a cycle, and a stopwatch without effect.
#pragma once

#include <array>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The stages of one cycle, in their order.
enum class CycleStage : unsigned char {
  sense,    ///< computation of mean wrenches on the links from samples
  resolve,  ///< evaluation of laws, dynamics and the virtual robot
  guard,    ///< the last check of the command
  count
};
inline constexpr std::size_t stage_count = static_cast<std::size_t>(CycleStage::count);

constexpr const char* name(CycleStage stage) noexcept {
  constexpr const char* names[] = {"sense", "resolve", "guard"};
  return stage < CycleStage::count ? names[static_cast<std::size_t>(stage)] : "unknown";
}

/// A stopwatch that measures nothing and costs nothing.
struct NoStopwatch {
  SKINCTL_INLINE void begin() noexcept {}
  SKINCTL_INLINE void end(CycleStage) noexcept {}
  [[nodiscard]] constexpr Nanoseconds operator[](CycleStage) const noexcept { return {}; }
};

SKINCTL_END_NAMESPACE
