// SPDX-License-Identifier: BSD-3-Clause
// Send-on-delta: a cell sends a sample only after a change, for simulated skins.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cell measures at its own rate and sends a sample if one of its numbers differs from the last one sent by
/// at least its delta, or if it has been silent for `keep_alive`. So the receiver's value has an error of
/// less than a delta, and an age of at most `keep_alive`.
///
/// What was left unsaid below a delta stands until the next message: after a release it pushes on. With a
/// `patience` a cell that has been silent for so long sends a smaller change of force too, from `fine` on: a
/// fast change at once, a slow one at the rate of patience, the last bit of each soon after it.
class SendOnDelta {
 public:
  /// The smallest changes that trigger a message.
  struct Deltas {
    float force = 2.0f / 1024;  ///< change of one of the three force readings
    float proximity = 0.004f;
    float acceleration = 1;    ///< change along one axis [m/s^2]
    float temperature = 0.5f;  ///< change of temperature [K]
    float fine = 2.0f / 1024;  ///< change of a force reading after `patience`; above the noise
  };
  /// The last sample sent; none in `Memory{}`. One per cell.
  struct Memory {
    CellSample last;
    bool any = false;
  };

  /// @param patience  silence after which changes of force from `fine` on are sent as well; never by default.
  /// Throws `ConfigurationError` unless every delta, `keep_alive` and `patience` are > 0, and deltas at most
  /// 1e6.
  explicit SendOnDelta(const Deltas& deltas, Nanoseconds keep_alive = 100ms,
                       Nanoseconds patience = Nanoseconds::max())
      : deltas_(deltas), keep_alive_(keep_alive), patience_(patience) {
    const auto allowed = [](float x) { return x > 0 && x <= 1e6f; };
    require(allowed(deltas.force), "SendOnDelta: force", double(deltas.force), "> 0, <= 1e6");
    require(allowed(deltas.proximity), "SendOnDelta: proximity", double(deltas.proximity), "> 0, <= 1e6");
    require(allowed(deltas.acceleration), "SendOnDelta: acceleration", double(deltas.acceleration),
            "> 0, <= 1e6 m/s^2");
    require(allowed(deltas.temperature), "SendOnDelta: temperature", double(deltas.temperature),
            "> 0, <= 1e6 C");
    require(allowed(deltas.fine), "SendOnDelta: fine", double(deltas.fine), "> 0, <= 1e6");
    require(patience > 0ns, "SendOnDelta: patience", milliseconds(patience), "> 0 ms");
    require(keep_alive > 0ns, "SendOnDelta: keep_alive", milliseconds(keep_alive), "> 0 ms");
  }

  /// Whether this sample is sent; if so, the memory stores it. A number that is not finite is always sent, so
  /// that the receiver can report it.
  [[nodiscard]] bool send(Memory& memory, const CellSample& now) const noexcept {
    const CellSample& last = memory.last;
    bool changed = !memory.any || now.time - last.time >= keep_alive_ ||
                   differ(now.proximity, last.proximity, deltas_.proximity) ||
                   differ(now.temperature, last.temperature, deltas_.temperature);
    const float force =
        now.time - last.time >= patience_ && deltas_.fine < deltas_.force ? deltas_.fine : deltas_.force;
    for (std::size_t k = 0; k < 3; ++k)
      changed = changed || differ(now.force[k], last.force[k], force) ||
                differ(now.acceleration[k], last.acceleration[k], deltas_.acceleration);
    if (changed) memory = {now, true};
    return changed;
  }

 private:
  static bool differ(float a, float b, float delta) noexcept { return !(std::abs(a - b) < delta); }
  Deltas deltas_;
  Nanoseconds keep_alive_, patience_;
};

SKINCTL_END_NAMESPACE
