// A person who moves the box while the arms work, and no hand is over it.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "examples/packing_oranges/world.hpp"

namespace packing {

class BoxMover {
 public:
  static constexpr int times = 3;                  ///< it is moved, at most
  static constexpr double first = 10, every = 18;  ///< when it wants to, and how long after each time [s]

  /// @param far  way of each move, and the largest distance from where the box stands at first [m].
  BoxMover(double far, std::uint64_t seed) : far_(far), random_(seed) {}

  /// A millisecond; how often it has begun to.
  int step(World& world) {
    const double t = skinctl::seconds<double>(world.now());
    const Tray box = world.tray(0);
    stood_ = {world.first()[0].x, world.first()[0].y, 0};
    if (!moves_ && moved_ < times && t >= next_ && !is_over(world, box)) {
      from_ = {box.x, box.y, 0};
      to_ = elsewhere(from_);
      moves_ = true, begun_ = t;
      ++moved_;
    }
    if (moves_) world.pull_tray(0, pull(world, box, t - begun_));
    if (moves_ && t - begun_ > lasts + settles) {
      world.pull_tray(0, {0, 0, 0});
      moves_ = false, next_ = t + every;
    }
    return moved_;
  }

 private:
  using Place = skinctl::Xyz<double>;
  static constexpr double lasts = 0.8, settles = 0.3;  ///< of a way, and of the hold at its end [s]
  static constexpr double waits_for = 0.35;  ///< distance of a hand from the middle that is over the box [m]
  static constexpr double stiffness = 2000, damping = 90, strength = 60;  ///< of an arm [N/m, N s/m, N]

  [[nodiscard]] static bool is_over(const World& world, const Tray& box) {
    for (std::size_t a = 0; a < arms; ++a)
      if (const Place p = world.hand(a); std::hypot(p.x - box.x, p.y - box.y) < waits_for) return true;
    return false;
  }
  /// So far in some direction, and no further from the first place.
  [[nodiscard]] Place elsewhere(const Place& from) {
    constexpr int tries = 50;
    for (int n = 0; n < tries; ++n) {
      const double angle = std::uniform_real_distribution<double>(-M_PI, M_PI)(random_);
      const Place to = from + far_ * Place{std::cos(angle), std::sin(angle), 0};
      if (std::hypot(to.x - stood_.x, to.y - stood_.y) <= 1.01 * far_) return to;
    }
    return stood_;
  }
  /// Towards where the hand is on its way of least jerk.
  [[nodiscard]] Place pull(const World& world, const Tray& box, double t) const {
    const double s = std::min(1.0, t / lasts);
    const double way = s * s * s * (10 - 15 * s + 6 * s * s), speed = 30 * s * s * (1 - s) * (1 - s) / lasts;
    const Place goal = from_ + way * Place(to_ - from_), v = speed * Place(to_ - from_);
    const Place at{box.x, box.y, 0};
    const Place force = stiffness * Place(goal - at) + damping * Place(v - world.tray_velocity(0));
    const double size = norm(force);
    return size > strength ? (strength / size) * force : force;
  }

  double far_;
  std::mt19937_64 random_;
  Place stood_{0, 0, 0}, from_{0, 0, 0}, to_{0, 0, 0};
  bool moves_ = false;
  double begun_ = 0, next_ = first;
  int moved_ = 0;
};

}  // namespace packing
