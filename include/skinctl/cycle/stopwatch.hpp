// SPDX-License-Identifier: BSD-3-Clause
// A stopwatch for the stages of a cycle.
#pragma once

#include <array>
#include <chrono>

#include "skinctl/cycle/stage.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Measures each stage of a cycle with the system's steady clock (some 20 ns a reading; no system call on
/// Linux).
class Stopwatch {
 public:
  SKINCTL_INLINE void begin() noexcept { last_ = now(); }
  SKINCTL_INLINE void end(CycleStage stage) noexcept {
    const Nanoseconds t = now();
    times_[static_cast<std::size_t>(stage)] = t - last_;
    last_ = t;
  }
  [[nodiscard]] Nanoseconds operator[](CycleStage stage) const noexcept {
    return times_[static_cast<std::size_t>(stage)];
  }
  /// The time of all stages together.
  [[nodiscard]] Nanoseconds total() const noexcept {
    Nanoseconds sum{};
    for (const Nanoseconds t : times_) sum += t;
    return sum;
  }
  [[nodiscard]] static Nanoseconds now() noexcept {
    return std::chrono::steady_clock::now().time_since_epoch();
  }

 private:
  Nanoseconds last_{};
  std::array<Nanoseconds, stage_count> times_{};
};

SKINCTL_END_NAMESPACE
