// SPDX-License-Identifier: BSD-3-Clause
// The gripper of a set of skills: its goal as requests and skills give it, its state as the cycle is told it.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/gripper.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The addition of skills with a gripper to the input of a scene.
struct GripperInput {
  GripperState gripper{};  ///< last report of the gripper

  template <class F>
  friend void each_number(GripperInput& input, F&& f) {
    each_number(input.gripper, f);
  }
};
/// The addition of skills with a gripper to the output of a scene.
struct GripperOutput {
  GripperCommand gripper{};  ///< request to the gripper
};

/// The gripper of a set of skills. Goals are limited to its range before they are passed on.
class OneGripper {
 public:
  struct Memory {
    GripperCommand command{};
    GripperState state{};
    Nanoseconds goal_time{};       ///< time of the first cycle with the newest goal
    bool answered = false;         ///< the state is newer than the goal
    bool goal_time_known = false;  ///< `goal_time` is known
  };

  /// Throws `ConfigurationError` for a range that no gripper can have.
  SKINCTL_COLD explicit OneGripper(const GripperRange& range) : range_(range) {
    require(range.opening > 0 && range.opening <= 10, "OneGripper: opening", range.opening, "> 0, <= 10 m");
    require(range.min_force >= 0 && range.min_force <= range.max_force && range.max_force <= 1e5,
            "OneGripper: largest force", range.max_force, ">= the least one, <= 1e5 N");
    require(range.min_speed >= 0 && range.min_speed <= range.max_speed && range.max_speed <= 1e3,
            "OneGripper: largest speed", range.max_speed, ">= the least one, <= 1e3 m/s");
  }
  [[nodiscard]] const GripperRange& range() const noexcept { return range_; }

  /// Takes a goal, limited to the range; one that is not finite is ignored, and the last one stays.
  void ask(Memory& m, const GripperGoal& goal) const noexcept {
    if (!finite(goal)) return;
    m.command.goal = limited(goal, range_);
    ++m.command.count;
    m.answered = m.goal_time_known = false;
  }
  /// Takes the state heard at `now`. One from before the goal says nothing about it.
  static void hear(Memory& m, const GripperState& state, Nanoseconds now) noexcept {
    if (!m.goal_time_known) {
      m.goal_time = now;
      m.goal_time_known = true;
    }
    m.state = state;
    m.answered = state.heard && state.time > m.goal_time;
  }
  [[nodiscard]] static const GripperCommand& command(const Memory& m) noexcept { return m.command; }
  /// Whether something is between the fingers.
  [[nodiscard]] static bool holds(const Memory& m) noexcept { return m.answered && m.state.holding; }
  /// Whether the fingers have stopped at the newest goal, or at an object on the way to it.
  [[nodiscard]] static bool stands(const Memory& m) noexcept {
    return m.answered && !m.state.moving && m.state.error == GripperError::none;
  }
  [[nodiscard]] static bool broken(const Memory& m) noexcept {
    return m.answered && m.state.error != GripperError::none && m.state.error != GripperError::silent;
  }

 private:
  GripperRange range_;
};

SKINCTL_END_NAMESPACE
