// SPDX-License-Identifier: BSD-3-Clause
// The output of a cycle.
#pragma once

#include <array>

#include "skinctl/core/command.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The output of one cycle. A law of the scene may add to it, such as `gripper` of skills with a gripper.
/// @tparam Command  a `RobotCommand`.
template <class Command, std::size_t N, Scalar T, std::size_t Terms>
struct CycleOutput {
  Command command;                              ///< command for the robot, to be sent if it is valid
  JointCommand<N, T> planned;                   ///< motion and torque behind the command, to look at
  Status status;                                ///< reasons for limits, holds and refusals
  std::array<JointTorque<N, T>, Terms> shares;  ///< torque of each law in the last sub-step [N m]

  CycleOutput() = default;
  /// Writes each member once: GCC would zero all of them before, by an instruction that starts slowly.
  SKINCTL_INLINE CycleOutput(const JointCommand<N, T>& given, Status found,
                             const std::array<JointTorque<N, T>, Terms>& parts) noexcept
      : command(given), planned(given), status(found), shares(parts) {}
};

SKINCTL_END_NAMESPACE
