// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a cycle, whatever its scene: what messages and files take.
#pragma once

#include <cstdint>
#include <span>

#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Views of the numbers of one cycle.
struct CycleNumbers {
  std::uint32_t number = 0;          ///< number of the cycle, from 0
  Nanoseconds now{};                 ///< time of the cycle
  Nanoseconds measured{};            ///< time of the robot's state
  std::span<const double> q{};       ///< measured positions [rad] or [m]
  std::span<const double> dq{};      ///< measured velocities [rad/s] or [m/s]
  std::span<const double> torque{};  ///< commanded torques, 0 where the command has none [N m]
  std::span<const double> shares{};  ///< torques of the laws, all joints of a law before the next law [N m]
  std::span<const CellSample> samples{};
  std::span<const Nanoseconds> times{};  ///< durations of the stages
  Status status{};
  std::span<const unsigned char> bytes{};  ///< the cycle as `CycleBytes` has it
};

SKINCTL_END_NAMESPACE
