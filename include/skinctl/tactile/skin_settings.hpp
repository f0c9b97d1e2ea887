// Thresholds and times of a skin's readings.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/sensing/event_gate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Thresholds and times that all cells of a skin share. The defaults suit TUM's cells at 250 Hz with a
/// keep-alive of at most 100 ms.
struct SkinSettings {
  EventGate<> force = EventGate<>::dead_band(0.08);      ///< on the sum of the three force readings
  EventGate<> proximity = EventGate<>::dead_band(0.05);  ///< on the proximity reading
  Nanoseconds max_age = 250ms;  ///< age of the last sample from which a cell does not push
  Nanoseconds fade = 50ms;      ///< in the last part of `max_age` its force goes linearly to 0
  Nanoseconds ramp = 6ms;       ///< longest duration of a change of reading before its sample
  Nanoseconds catch_up = 20ms;  ///< missing impulse before an interval is added up to this time back
  Nanoseconds max_ahead = 2ms;  ///< a stamp up to this time after the interval counts as its end

  /// Throws `ConfigurationError` unless `fade` and `ramp` > 0, `max_age >= fade`, and the others >= 0.
  void check() const {
    require(fade > 0ns, "SkinSettings: fade", milliseconds(fade), "> 0 ms");
    require(max_age >= fade, "SkinSettings: max_age", milliseconds(max_age), ">= fade [ms]");
    require(ramp > 0ns, "SkinSettings: ramp", milliseconds(ramp), "> 0 ms");
    require(catch_up >= 0ns, "SkinSettings: catch_up", milliseconds(catch_up), ">= 0 ms");
    require(max_ahead >= 0ns, "SkinSettings: max_ahead", milliseconds(max_ahead), ">= 0 ms");
  }
};

SKINCTL_END_NAMESPACE
