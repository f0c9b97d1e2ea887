// SPDX-License-Identifier: BSD-3-Clause
// The sample of a force-torque sensor at one time, and its plausibility check.
#pragma once

#include <array>

#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One reading of a force-torque sensor: the wrench that the world exerts on the robot beyond the sensor,
/// about the sensor's origin, along the sensor's axes. A hand that pushes the tool along the sensor's +x
/// gives a positive `force[0]`. A device that reports the reaction (the robot's load on the world) has the
/// opposite sign: negate all six numbers where the sample is made.
struct WrenchSample {
  Nanoseconds time{};              ///< time of the measurement
  std::array<double, 3> force{};   ///< force on the robot, along the sensor's axes [N]
  std::array<double, 3> moment{};  ///< moment on the robot about the sensor's origin, along its axes [N m]
};

/// Empty if the sample is valid; `sample_not_finite` if a number is NaN or infinite; `sample_out_of_range` if
/// a component of force exceeds `max_force` [N], or one of moment `max_moment` [N m]: the sensor is
/// saturated, and what it reads is not what acts.
[[nodiscard]] SKINCTL_INLINE constexpr Status check(const WrenchSample& sample, double max_force,
                                                    double max_moment) noexcept {
  bool finite = true, within = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const double f = sample.force[i], m = sample.moment[i];
    finite = finite && f - f == 0 && m - m == 0;
    within = within && f <= max_force && f >= -max_force && m <= max_moment && m >= -max_moment;
  }
  if (!finite) return Reason::sample_not_finite;
  return within ? Status{} : Status{Reason::sample_out_of_range};
}

SKINCTL_END_NAMESPACE
