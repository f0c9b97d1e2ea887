// SPDX-License-Identifier: BSD-3-Clause
// What a gripper is asked for, and what it reports.
#pragma once

#include <cstdint>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The largest opening of a gripper, and its ranges of force and speed. One that only opens and closes has
/// one force and one speed.
struct GripperRange {
  double opening = 0;    ///< largest distance of the fingers [m]
  double min_force = 0;  ///< smallest force on an object [N]
  double max_force = 0;  ///< largest force on an object [N]
  double min_speed = 0;  ///< smallest speed of the opening [m/s]
  double max_speed = 0;  ///< largest speed of the opening [m/s]
};

/// The opening that the fingers shall reach, the force with which they shall hold an object that is in the
/// way, and their speed. A number beyond the gripper's range counts as the end of the range.
struct GripperGoal {
  double opening = 0;  ///< distance of the fingers [m]
  double force = 0;    ///< force on an object that is in the way [N]
  double speed = 0;    ///< speed of the opening [m/s]

  friend bool operator==(const GripperGoal&, const GripperGoal&) noexcept = default;
};

/// The request of a cycle to a gripper: the goal is a new one when `count` has changed; 0: there has been
/// none.
struct GripperCommand {
  GripperGoal goal{};
  std::uint32_t count = 0;
};

/// A set of skills without a gripper.
struct NoGripper {
  struct Memory {};
};

/// The goal with each number brought into the gripper's range.
[[nodiscard]] constexpr GripperGoal limited(const GripperGoal& goal, const GripperRange& range) noexcept {
  const auto within = [](double x, double low, double high) { return x < low ? low : x > high ? high : x; };
  return {within(goal.opening, 0.0, range.opening), within(goal.force, range.min_force, range.max_force),
          within(goal.speed, range.min_speed, range.max_speed)};
}
/// Whether no number of the goal is NaN or infinite.
[[nodiscard]] constexpr bool finite(const GripperGoal& goal) noexcept {
  return (goal.opening - goal.opening) + (goal.force - goal.force) + (goal.speed - goal.speed) == 0;
}

/// The reason for which a gripper does not do as it was told.
enum class GripperError : unsigned char {
  none,
  silent,   ///< no answer in time: the state is the last that was heard
  lost,     ///< connection gone, or silent for too long
  stopped,  ///< the gripper's own safety has stopped it
  fault     ///< a fault is reported: `GripperState::code` is its number
};

[[nodiscard]] constexpr const char* describe(GripperError error) noexcept {
  switch (error) {
    case GripperError::none:
      return "the gripper is well";
    case GripperError::silent:
      return "the gripper has not answered in time";
    case GripperError::lost:
      return "the gripper is gone";
    case GripperError::stopped:
      return "the gripper's own safety has stopped it";
    case GripperError::fault:
      return "the gripper reports a fault";
  }
  return "";
}

/// The last report of a gripper.
struct GripperState {
  Nanoseconds time{};  ///< time of the newest answer, on the clock that `poll` was given
  double opening = 0;  ///< distance of the fingers [m]
  /// Force on the object that it holds [N]; 0 while it holds none. A gripper that does not measure it reports
  /// the force of its goal.
  double force = 0;
  bool heard = false;    ///< whether an answer came since the connection; until then the others mean nothing
  bool moving = false;   ///< whether the fingers are on their way to the newest goal
  bool holding = false;  ///< whether the fingers stand still because an object is between them
  /// Whether the opening comes from a sensor. Otherwise it is an estimate from the time since the last goal.
  bool measured = false;
  GripperError error = GripperError::none;
  std::uint16_t code = 0;  ///< the maker's number of the fault
};

SKINCTL_END_NAMESPACE
