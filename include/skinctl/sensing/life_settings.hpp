// SPDX-License-Identifier: BSD-3-Clause
// How far a place may give way to a push that has no life.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A body that presses a robot comes, trembles, and gives when the robot leaves. What sticks, creeps or
/// dithers within a sensor's noise does none of these: its push counts less with each millimetre that its
/// place gives way to it.
struct LifeSettings {
  /// Total distance that a place gives way until a push on it counts nothing [m]; where neighbours with life
  /// push too, only the share of the place's own force counts. An arm that stops within it meets nobody; a
  /// calm hand has shown its tremor long before.
  double way = 0.008;
  /// Largest sum of pushes without life [N]: more than a blow of 2 kN/m at 0.5 m/s reaches in the 16 ms
  /// before its life shows, and so little that friction stops the arm again within a few millimetres.
  double force = 30;
  /// Mass with which the arm is felt [kg]: the damping of such pushes is critical for it,
  /// `2 sqrt(mass force / way)`.
  double mass = 5;
  /// Push up to which a cell lives if the sum of it and its pressed neighbours does [N]: at the rim of a
  /// touch the tremor of a hand is below the sensor's noise.
  double rim_force = 3;
  /// Time for which a push lives after its last sign of life: two periods of a hand's tremor, 8 Hz.
  Nanoseconds held = 250ms;
  Nanoseconds calm = 10s;  ///< time without a push after which a quiet cell counts again

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD void check() const {
    require(way >= 1e-4 && way <= 1, "LifeSettings: way", way, "1e-4 to 1 m");
    require(force >= 0 && force <= 1e6, "LifeSettings: force", force, "0 to 1e6 N");
    require(mass > 0 && mass <= 1000, "LifeSettings: mass", mass, "> 0, <= 1000 kg");
    require(rim_force >= 0 && rim_force <= 1e6, "LifeSettings: rim_force", rim_force, "0 to 1e6 N");
    require(held >= 20ms && held <= 10s, "LifeSettings: held", milliseconds(held), "20 to 10000 ms");
    require(calm > 0ns && calm <= 3600s, "LifeSettings: calm", milliseconds(calm), "> 0 ms, <= 1 h");
  }
};

SKINCTL_END_NAMESPACE
