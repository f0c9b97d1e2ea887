// The firmware of a parallel gripper: goals to the opening that its fingers are driven to, 1000 times a second.
#pragma once

#include <algorithm>
#include <cmath>

#include "skinctl/core/gripper.hpp"

namespace packing {

/// How far the gripper opens, and its forces and speeds.
inline constexpr skinctl::GripperRange gripper_range{0.11, 0.5, 12, 0.005, 0.15};

/// A gripper that takes only "open" and "close": whatever it is asked for, it goes with this force and speed.
inline constexpr double firm_force = 5, firm_speed = 0.1;  // [N], [m/s]

/// Moves the opening towards its goal at the goal's speed; once something is between the fingers, regulates the force:
/// the opening changes by `gain` times what the force lacks, at the goal's speed at most.
class Gripper {
 public:
  static constexpr double gain = 0.02;     ///< [m/s per N]
  static constexpr double touched = 0.3;   ///< force from which something is between the fingers [N]
  static constexpr double filter = 0.004;  ///< time constant of the force's low pass [s]
  static constexpr double steady = 0.03;   ///< it holds when the force has been right for this long [s]

  /// @param binary  it is only open or closed, and does not tell its opening.
  explicit Gripper(bool binary = false) : binary_(binary) {}

  void command(const skinctl::GripperCommand& c) {
    if (c.count == 0 || c.count == count_) return;
    count_ = c.count;
    goal_ = limited(c.goal, gripper_range);
    const bool opens = goal_.opening > gripper_range.opening / 2;
    if (binary_) goal_ = {opens ? gripper_range.opening : 0, firm_force, firm_speed};
    right_for_ = 0;
  }
  /// A millisecond, with the opening and the force that are measured: the opening to go for.
  double step(double opening, double force, double dt) {
    force_ += dt / (filter + dt) * (force - force_);
    const bool closes = goal_.opening < wanted_;
    const bool in_hand = force_ > touched && count_ > 0;
    double rate = 0;
    if (count_ > 0 && in_hand && closes) {
      rate = -std::clamp(gain * (goal_.force - force_), -goal_.speed, goal_.speed);
      const bool right = std::abs(force_ - goal_.force) < 0.15 + 0.1 * goal_.force;
      right_for_ = right ? right_for_ + dt : 0;
    } else if (count_ > 0) {
      rate = std::clamp((goal_.opening - wanted_) / dt, -goal_.speed, goal_.speed);
      right_for_ = 0;
    }
    const bool blocked = count_ > 0 && !closes && wanted_ - opening > 0.008;
    blocked_for_ = blocked ? blocked_for_ + dt : 0;
    // What is driven to stays near what is: fingers that something pushes open do not close with a jump.
    wanted_ = std::clamp(wanted_ + rate * dt, std::max(0.0, opening - 0.01), opening + 0.01);
    opening_ = opening;
    moving_ = std::abs(goal_.opening - opening) > 5e-4 && count_ > 0;
    return wanted_;
  }
  /// What it reports at `now`; `force`: the sensor's last reading.
  [[nodiscard]] skinctl::GripperState state(skinctl::Nanoseconds now, double force) const {
    const bool holding = right_for_ >= steady;
    return {now,
            binary_ ? goal_.opening : opening_,
            force,
            true,
            moving_ && !holding && blocked_for_ < steady,
            holding,
            !binary_,
            skinctl::GripperError::none,
            0};
  }
  [[nodiscard]] double wanted() const { return wanted_; }
  /// Force with which a finger may be driven outwards, half of the goal's, as both are coupled; closing: any [N].
  [[nodiscard]] double opens_with() const { return goal_.opening < wanted_ ? 1e9 : goal_.force / 2; }

 private:
  bool binary_;
  skinctl::GripperGoal goal_{gripper_range.opening, 1, 0.05};
  double wanted_ = gripper_range.opening, opening_ = gripper_range.opening, force_ = 0, right_for_ = 0,
         blocked_for_ = 0;
  std::uint32_t count_ = 0;
  bool moving_ = false;
};

}  // namespace packing
