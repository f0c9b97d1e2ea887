// Concept of a gripper's driver.
#pragma once

#include <concepts>

#include "skinctl/core/gripper.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A gripper on the other end of a driver. Nothing here blocks: a loop calls `poll` once a cycle.
///
/// - `range()` is what it can do.
/// - `move(goal)` asks for a new goal, whatever it does at the time; the newest goal counts. False: the goal is not
///   finite, or the gripper is lost.
/// - `poll(now)` exchanges what is due and gives the newest state. A gripper that does not answer is `silent`,
///   later `lost`; no state is older than the driver's time limit without saying so.
/// - `stop()` halts the fingers where they are, as far as the gripper can.
template <class G>
concept GripperDriver = requires(G& gripper, const G& same, const GripperGoal& goal, Nanoseconds now) {
  { same.range() } noexcept -> std::same_as<GripperRange>;
  { gripper.move(goal) } noexcept -> std::same_as<bool>;
  { gripper.poll(now) } noexcept -> std::same_as<GripperState>;
  { gripper.stop() } noexcept;
};

/// A goal with the largest opening; with the least: an object of any size is held with `force` [N].
[[nodiscard]] constexpr GripperGoal opened(const GripperRange& range) noexcept {
  return {range.opening, range.greatest_force, range.greatest_speed};
}
[[nodiscard]] constexpr GripperGoal closed(const GripperRange& range, double force) noexcept {
  return {0, force, range.greatest_speed};
}

SKINCTL_END_NAMESPACE
