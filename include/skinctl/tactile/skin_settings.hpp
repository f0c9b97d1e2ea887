// SPDX-License-Identifier: BSD-3-Clause
// Thresholds and times of a skin's readings.
#pragma once

#include <type_traits>

#include "skinctl/core/contract.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/event_gate.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Throws `ConfigurationError` unless the times `s` of a skin are as `SkinSettings::check` says.
template <class Settings>
SKINCTL_COLD void check_times(const Settings& s) {
  require(s.fade > 0ns, "SkinSettings: fade", milliseconds(s.fade), "> 0 ms");
  require(s.max_age >= s.fade, "SkinSettings: max_age", milliseconds(s.max_age), ">= fade [ms]");
  require(s.ramp > 0ns, "SkinSettings: ramp", milliseconds(s.ramp), "> 0 ms");
  require(s.catch_up >= 0ns, "SkinSettings: catch_up", milliseconds(s.catch_up), ">= 0 ms");
  require(s.max_ahead >= 0ns, "SkinSettings: max_ahead", milliseconds(s.max_ahead), ">= 0 ms");
}
}  // namespace detail

/// Thresholds and times that all cells of a skin share. The defaults suit TUM's cells at 250 Hz with a
/// keep-alive of at most 100 ms.
struct SkinSettings {
  EventGate<> force = EventGate<>::dead_band(0.08);      ///< gate of the sum of the three force readings
  EventGate<> proximity = EventGate<>::dead_band(0.05);  ///< gate of the proximity reading
  Nanoseconds max_age = 250ms;  ///< age of the last sample from which a cell does not push
  Nanoseconds fade = 50ms;      ///< last part of `max_age`, in which the force goes linearly to 0
  Nanoseconds ramp = 6ms;       ///< longest time before a sample in which its change of reading happened
  Nanoseconds catch_up = 20ms;  ///< time before an interval up to which missing impulse is made up
  Nanoseconds max_ahead = 2ms;  ///< largest time by which a stamp may be later than the interval

  /// Throws `ConfigurationError` unless `fade` and `ramp` > 0, `max_age >= fade`, and the others >= 0.
  void check() const { detail::check_times(*this); }
  /// The gates in the order of the channels.
  [[nodiscard]] std::array<EventGate<>, 2> gates() const { return {force, proximity}; }
};

/// Thresholds and times that all cells of a kind share: see `SkinSettings`.
template <SensorKind Kind>
struct ChannelSettings {
  /// Gate on the amount of each channel that pushes, in the order of the kind; on the magnitude where a
  /// friction cone limits it. By default a dead band of a hundredth of the greatest amount; none where a cone
  /// limits it.
  std::array<EventGate<>, KindTable<Kind>::pushing> gate = [] {
    std::array<EventGate<>, KindTable<Kind>::pushing> gates;
    for (std::size_t c = 0; c < gates.size(); ++c)
      if (!KindTable<Kind>::has_cone(c)) gates[c] = EventGate<>::dead_band(0.01 * Kind::channels[c].greatest);
    return gates;
  }();
  Nanoseconds max_age = 250ms, fade = 50ms, ramp = 6ms, catch_up = 20ms,
              max_ahead = 2ms;  ///< see `SkinSettings`

  /// Throws `ConfigurationError` for times that `SkinSettings::check` refuses.
  void check() const { detail::check_times(*this); }
  [[nodiscard]] const auto& gates() const noexcept { return gate; }
};

template <SensorKind Kind>
using SettingsOf = std::conditional_t<std::is_same_v<Kind, Hexagon>, SkinSettings, ChannelSettings<Kind>>;

SKINCTL_END_NAMESPACE
