// A forearm that a hand leads into a spring: how hard it hits, and whether it comes to rest there.
#pragma once

#include <algorithm>
#include <cmath>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "tests/support/touched_arm.hpp"

namespace skinctl::testing {

/// Cells on opposite sides of a UR5's forearm, for a hand and for what it leads the arm into.
inline const std::vector<PlacedCell<2>>& forearm_cells() {
  static const std::vector<PlacedCell<2>> cells{cell_at<2>(1, {-0.2, 0, 0.06}, {0, 0, 1}),
                                                cell_at<2>(2, {-0.2, 0, -0.06}, {0, 0, -1})};
  return cells;
}
/// @param heavier  by how much the arm is felt heavier: the gain is divided by it.
inline auto forearm_skin(double heavier = 1) {
  return open_skin(Patch<2, 2>(
      forearm_cells(), {.force = open_gains.force / heavier, .proximity = open_gains.proximity / heavier}));
}

/// A UR5 that gives way, at a period and a delay.
inline RobotConfiguration<6> yielding_arm(Nanoseconds period, Nanoseconds delay = 8ms, Nanoseconds lag = 8ms,
                                          double heavier = 1) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(20.0), .period = period, .delay = delay, .lag = lag};
  c.virtual_damping = 4 / heavier;
  c.viscous_friction = JointTorque<6>::constant(2 / heavier);
  c.dead_band = JointPosition<6>::constant(0.02);
  return c;
}

/// The force of the spring [N].
struct SpringForce {
  double speed = 0;            ///< of the arm when it met the spring [m/s]
  double peak = 0;             ///< largest
  double rest = 0, swing = 0;  ///< mean, and from least to largest, in the last second
  /// Whether it rests: swings by less than 5 % of the hand's push.
  [[nodiscard]] bool calm(double push) const { return swing < 0.05 * push; }
};

/// A hand leads the arm with `push` [N] into a spring of `stiffness` that stands 10 mm away, for `time` [s].
template <class Scene>
SpringForce led_into_a_spring(const Scene& scene, const RobotConfiguration<6>& c, double stiffness,
                              double push = 20, double time = 6) {
  constexpr double gap = 0.01;
  TouchedArm<2, Scene> arm(scene, forearm_cells(), {0.1, -1.2, 1.4, -1.8, -1.57, 0.3},
                           seconds<double>(c.delay), seconds<double>(c.lag));
  SpringForce out;
  double low = 1e9, high = 0, sum = 0;
  int n = 0;
  while (arm.time() < time) {
    arm.step(c.period, [&](std::size_t k, const CellAt& at) -> CellTouch {
      if (k == 0) return {.force = push * std::min(1.0, at.time / 0.1), .proximity = 0};
      if (at.out < gap) out.speed = out.peak > 0 ? out.speed : at.speed;
      return {.force = std::max(0.0, stiffness * (at.out - gap)), .proximity = 0};
    });
    const double force = arm.force[1];
    out.peak = std::max(out.peak, force);
    if (arm.time() < time - 1) continue;
    low = std::min(low, force), high = std::max(high, force), sum += force, ++n;
  }
  out.rest = sum / n;
  out.swing = high - low;
  return out;
}

}  // namespace skinctl::testing
