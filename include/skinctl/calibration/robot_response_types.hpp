// SPDX-License-Identifier: BSD-3-Clause
// What an identification of a robot's response takes and gives.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "skinctl/calibration/estimate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Commands and measurements of a motion, times in seconds of one clock, in their order.
template <std::size_t N>
struct ResponseLog {
  struct Entry {
    double time = 0;
    std::array<double, N> q{};  ///< joint positions [rad]
  };
  std::vector<Entry> sent;      ///< commands; each holds until the next one
  std::vector<Entry> measured;  ///< measurements, timed by their stamps
};

/// The identified response of a robot by position. In `measured = H(command) + gap - compliance G(q) -
/// hysteresis sign(dq)` H is a pure delay and a lag of first order.
template <std::size_t N>
struct RobotResponse {
  Estimate delay;        ///< delay from a command to the begin of the motion [s]
  Estimate lag;          ///< time constant of the lag [s]
  Estimate total_delay;  ///< delay plus lag, which is known better than each [s]
  struct Joint {
    /// Measured minus true position [rad], for a joint that goes where it is told but for its load.
    Estimate gap;
    Estimate compliance;    ///< one over the servo's stiffness [rad/(N m)]; known if gravity changed
    Estimate hysteresis;    ///< half of the dead zone of a joint that reverses, by friction or play [rad]
    double noise = 0;       ///< standard deviation of a measurement, after the fit [rad]
    double resolution = 0;  ///< step of the encoder [rad]; 0: not seen
    double speed = 0;       ///< largest measured speed [rad/s]
  };
  std::array<Joint, N> joint;
  double period = 0;   ///< median time between two measurements [s]
  double jitter = 0;   ///< standard deviation of the measurements' intervals, without lost ones [s]
  double skipped = 0;  ///< share of the measurements that are missing
};

SKINCTL_END_NAMESPACE
