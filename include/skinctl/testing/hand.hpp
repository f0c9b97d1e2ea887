// SPDX-License-Identifier: BSD-3-Clause
// A person's hand on a robot, for tests of contacts: a mass that the person leads by a spring, and a cover in
// between. Standard library only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace skinctl::testing {

/// A hand along one line, positive where it pushes. The person leads it by a spring and a damper, and pushes.
struct HandSettings {
  double mass = 5;                 ///< felt mass of hand and arm [kg]; infinite: a wall
  double stiffness = 300;          ///< spring of the arm, from the hand to its goal [N/m]
  double damping = 40;             ///< damping of the arm [N s/m]
  double push = 0;                 ///< constant force of the person [N]
  double tremor = 0;               ///< amplitude of the person's tremor [N]
  double tremor_frequency = 8;     ///< frequency of the tremor [Hz]
  double cover_stiffness = 10000;  ///< spring of the skin's cover and the flesh in series [N/m]
  double cover_damping = 10;       ///< damping of cover and flesh [N s/m]
  bool holds = false;              ///< whether the hand can pull, too
};

/// A hand that leads a robot gently.
[[nodiscard]] constexpr HandSettings leading_hand(double mass = 5, double stiffness = 300) noexcept {
  return {.mass = mass, .stiffness = stiffness, .damping = 40};
}
/// The fingertip of somebody who pokes: stiff muscles behind a light finger.
[[nodiscard]] constexpr HandSettings poking_finger() noexcept {
  return {.mass = 0.5, .stiffness = 1000, .damping = 20, .cover_stiffness = 3000, .cover_damping = 5};
}
/// Somebody who leans on a robot with a force [N]: heavy, soft, and without a goal of its own.
[[nodiscard]] constexpr HandSettings leaning_body(double force = 50) noexcept {
  return {.mass = 40,
          .stiffness = 0,
          .damping = 200,
          .push = force,
          .cover_stiffness = 5000,
          .cover_damping = 50};
}
/// A wall that stands, or moves as it is told, behind the robot's cover.
[[nodiscard]] constexpr HandSettings stiff_wall(double stiffness) noexcept {
  return {.mass = std::numeric_limits<double>::infinity(), .cover_stiffness = stiffness, .cover_damping = 0};
}

/// A point of a robot, or of a person's goal, along the line: its place [m] and speed [m/s].
struct AlongLine {
  double x = 0, v = 0;
};

/// One hand as a plant: `m dv/dt = K (goal - x) + D (goal' - v) + push + tremor - F`, and on the robot the
/// force `F = k (x - robot) + d (v - robot')` of the cover, 0 where it would pull and the hand does not hold.
/// By the midpoint rule, which neither makes nor loses energy: steps of a tenth of a millisecond are fine.
class Hand {
 public:
  /// @param x  place at which the hand begins, at rest [m]; it presses where this exceeds the robot's place.
  explicit Hand(const HandSettings& settings, double x = 0) noexcept : s_(settings), x_(x) {}

  /// Runs for `dt` [s], during which robot and goal move to these places, at constant speeds. Returns the
  /// mean force on the robot [N].
  double advance(double dt, double goal, double robot) noexcept {
    if (!started_) goal_ = goal, robot_ = robot, started_ = true;
    const AlongLine g{0.5 * (goal_ + goal), (goal - goal_) / dt},
        r{0.5 * (robot_ + robot), (robot - robot_) / dt};
    const double person =
        s_.push + s_.tremor * std::sin(6.283185307179586 * s_.tremor_frequency * (t_ + 0.5 * dt));
    goal_ = goal, robot_ = robot, t_ += dt;
    if (std::isinf(s_.mass)) {  // led: its mean speed is the goal's
      const double v = (goal - x_) / dt;
      force_ = contact(x_ + 0.5 * dt * v, v, r);
      x_ = goal, v_ = v;
      return force_;
    }
    double v = mean_speed(dt, g, r, person, true);
    if (cover(x_ + 0.5 * dt * v, v, r) < 0 && !s_.holds) v = mean_speed(dt, g, r, person, false);
    force_ = contact(x_ + 0.5 * dt * v, v, r);
    x_ += dt * v;
    v_ = 2 * v - v_;
    return force_;
  }

  [[nodiscard]] const HandSettings& settings() const noexcept { return s_; }
  [[nodiscard]] double x() const noexcept { return x_; }  ///< place of the hand [m]
  [[nodiscard]] double v() const noexcept { return v_; }  ///< speed of the hand [m/s]
  [[nodiscard]] double force() const noexcept {
    return force_;
  }  ///< mean force of the last step on the robot [N]

 private:
  double cover(double x, double v, const AlongLine& r) const noexcept {
    return s_.cover_stiffness * (x - r.x) + s_.cover_damping * (v - r.v);
  }
  double contact(double x, double v, const AlongLine& r) const noexcept {
    return s_.holds ? cover(x, v, r) : std::max(0.0, cover(x, v, r));
  }
  // The mean speed of a step, in which the cover counts or not.
  double mean_speed(double h, const AlongLine& goal, const AlongLine& robot, double person,
                    bool touches) const noexcept {
    const double k = touches ? s_.cover_stiffness : 0, d = touches ? s_.cover_damping : 0;
    return (2 * s_.mass / h * v_ + s_.stiffness * (goal.x - x_) + s_.damping * goal.v + person +
            k * (robot.x - x_) + d * robot.v) /
           (2 * s_.mass / h + s_.damping + d + 0.5 * h * (s_.stiffness + k));
  }

  HandSettings s_;
  double x_, v_ = 0, t_ = 0, goal_ = 0, robot_ = 0, force_ = 0;
  bool started_ = false;
};

/// Two hands that hold a robot from both sides, each pressing with `preload` [N]; they share a goal.
class Grip {
 public:
  /// @param x  position of the robot's point between the hands when they begin, pressed on it [m].
  Grip(const HandSettings& settings, double preload, double x = 0) noexcept
      : hands_{Hand(pressing(settings, preload), x + preload / settings.cover_stiffness),
               Hand(pressing(settings, preload), -x + preload / settings.cover_stiffness)},
        inset_(preload / settings.cover_stiffness) {}

  /// Runs both hands for `dt` [s], as `Hand::advance`; returns the force of both on the robot [N].
  double advance(double dt, double goal, double robot) noexcept {
    return hands_[0].advance(dt, goal + inset_, robot) - hands_[1].advance(dt, -goal + inset_, -robot);
  }
  /// The hand that pushes to the positive side (0), or the other one (1), along its own line.
  [[nodiscard]] const Hand& hand(unsigned i) const noexcept { return hands_[i]; }

 private:
  static constexpr HandSettings pressing(HandSettings s, double preload) noexcept {
    s.push += preload;
    s.holds = false;
    return s;
  }
  Hand hands_[2];
  double inset_;  // by which each hand's goal lies within the cover
};

}  // namespace skinctl::testing
