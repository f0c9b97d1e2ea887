// What a gripper is asked for, and what it reports.
#pragma once

#include <cstdint>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// What a gripper can do; the largest opening, and the ranges of force and speed. A gripper that only opens and
/// closes has one force and one speed.
struct GripperRange {
  double opening = 0;         ///< largest distance of the fingers [m]
  double least_force = 0;     ///< [N]
  double greatest_force = 0;  ///< [N]
  double least_speed = 0;     ///< of the opening [m/s]
  double greatest_speed = 0;  ///< [m/s]
};

/// Where the fingers shall go, and with how much force and speed at most. Numbers beyond the gripper's range are
/// taken to its ends.
struct GripperGoal {
  double opening = 0;  ///< [m]
  double force = 0;    ///< that it holds an object with [N]
  double speed = 0;    ///< [m/s]

  friend bool operator==(const GripperGoal&, const GripperGoal&) noexcept = default;
};

namespace detail {
[[nodiscard]] constexpr double limited(double x, double least, double greatest) noexcept {
  return x < least ? least : x > greatest ? greatest : x;
}
}  // namespace detail
/// The goal within the gripper's range.
[[nodiscard]] constexpr GripperGoal limited(const GripperGoal& goal, const GripperRange& range) noexcept {
  return {detail::limited(goal.opening, 0, range.opening),
          detail::limited(goal.force, range.least_force, range.greatest_force),
          detail::limited(goal.speed, range.least_speed, range.greatest_speed)};
}
/// Whether the goal has three numbers.
[[nodiscard]] constexpr bool finite(const GripperGoal& goal) noexcept {
  return (goal.opening - goal.opening) + (goal.force - goal.force) + (goal.speed - goal.speed) == 0;
}

/// Why a gripper does not do as it was told.
enum class GripperError : unsigned char {
  none,
  silent,   ///< it has not answered in time: the state is the last that was heard
  lost,     ///< its connection is gone, or it has been silent for too long
  stopped,  ///< its own safety has stopped it
  fault     ///< it reports a fault; `GripperState::code` is its number
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

/// What a gripper reported last.
struct GripperState {
  Nanoseconds time{};  ///< when it was heard, on the clock that `poll` was given
  double opening = 0;  ///< [m]
  /// With which it holds an object [N]; 0 while it holds none. Most grippers do not measure it: then it is the force
  /// of the goal.
  double force = 0;
  bool heard = false;    ///< since the connection; before that, nothing else here counts
  bool moving = false;   ///< on its way to the newest goal
  bool holding = false;  ///< the fingers stand still because an object is between them
  bool measured =
      false;  ///< the opening comes from a sensor; otherwise it is what the time since the goal gives
  GripperError error = GripperError::none;
  std::uint16_t code = 0;  ///< of a fault, as the maker counts them
};

SKINCTL_END_NAMESPACE
