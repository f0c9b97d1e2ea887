// SPDX-License-Identifier: BSD-3-Clause
// What the fault rules of cells are told: the noise of a cell, times and thresholds.
#pragma once

#include <cmath>
#include <cstdint>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The noise of one untouched cell, in steps of its sensors: the standard deviation of its noise before the
/// sensor rounds, and the mean.
struct SensorNoise {
  float force = 0.7f;      ///< standard deviation of one force sensor [steps]
  float proximity = 0.7f;  ///< standard deviation of the proximity [steps]
  float rest = 0;          ///< mean of one force sensor [steps]; 0: it may read exact zeros while untouched
  /// Whether equal readings may follow one another for any time, pressed or not, because its step is coarse
  /// or its readings are filtered before they arrive. Then equal readings show no fault; whole messages that
  /// are equal still do.
  bool repeats = false;
};

/// Settings of `CellHealth`.
struct CellHealthSettings {
  double step = 1.0 / 1024;  ///< step of the readings, as a share of their range
  /// For cells that send changes only: the smallest change of a force sensor that is sent (`SendOnDelta`)
  /// [steps]. Their readings move in steps of it, which is no noise. 0: they send all that they read.
  double delta = 0;
  /// Number of messages in a row with all eight numbers equal that shows a dead cell, also in between
  /// touches. 0: never, for cells without an accelerometer or other number that always has noise.
  std::uint32_t equal_messages = 5;
  double top = 0.98;  ///< force reading, 0 to 1, from which on a sensor is at the top of its range
  Nanoseconds saturated_for = 200ms;
  Nanoseconds fade_in = 50ms, fade_out = 250ms;  ///< times in which a mask fades in and out
  Nanoseconds hold = 2s, hold_blinking = 10s;    ///< times for which a mask stays after the last finding
  Nanoseconds witnessed_within = 12ms;  ///< time before or after a jump in which a witness shows it too

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD void check() const {
    require(step >= 1.0 / 60000 && step <= 0.1, "CellHealth: step", step, "1/60000 to 0.1");
    require(delta >= 0 && delta * step <= 0.1, "CellHealth: delta", delta, ">= 0 steps, <= 0.1 of the range");
    require(equal_messages != 1 && equal_messages <= 1000, "CellHealth: equal_messages",
            double(equal_messages), "0, or 2 to 1000");
    require(top > 0.5 && top <= 1, "CellHealth: top", top, "> 0.5, <= 1");
    const auto time = [](Nanoseconds t, const char* name) {
      require(t > 0ns && t <= 60s, name, milliseconds(t), "> 0 ms, <= 60 s");
    };
    time(saturated_for, "CellHealth: saturated_for"), time(fade_in, "CellHealth: fade_in");
    time(fade_out, "CellHealth: fade_out"), time(hold, "CellHealth: hold");
    time(hold_blinking, "CellHealth: hold_blinking"), time(witnessed_within, "CellHealth: witnessed_within");
  }
};

SKINCTL_END_NAMESPACE
