// SPDX-License-Identifier: BSD-3-Clause
// Concept of a gripper's driver.
#pragma once

#include <concepts>

#include "skinctl/core/gripper.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A gripper on the other end of a driver. Nothing here blocks: a loop calls `poll` once a cycle.
///
/// - `range()` gives its largest opening, forces and speeds.
/// - `move(goal)` replaces the goal, also during a motion. It returns false for a goal that is not finite and
///   for a gripper that is lost.
/// - `poll(now)` sends and receives what is due, and returns the newest state. A gripper that does not answer
///   within the driver's time limit is reported as `silent`, later as `lost`.
/// - `stop()` halts the fingers where they are, if the gripper can.
template <class G>
concept GripperDriver = requires(G& gripper, const G& same, const GripperGoal& goal, Nanoseconds now) {
  { same.range() } noexcept -> std::same_as<GripperRange>;
  { gripper.move(goal) } noexcept -> std::same_as<bool>;
  { gripper.poll(now) } noexcept -> std::same_as<GripperState>;
  { gripper.stop() } noexcept;
};

/// The goal of open fingers.
[[nodiscard]] constexpr GripperGoal open_goal(const GripperRange& range) noexcept {
  return {range.opening, range.max_force, range.max_speed};
}
/// The goal of closed fingers: an object between them is held with `force` [N].
[[nodiscard]] constexpr GripperGoal close_goal(const GripperRange& range, double force) noexcept {
  return {0, force, range.max_speed};
}

SKINCTL_END_NAMESPACE
