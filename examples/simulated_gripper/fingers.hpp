// Two fingers, and what they close on.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace simulated_gripper {

/// An object between the fingers.
struct Object {
  double width = 0;                                            ///< 0: there is none [m]
  double stiffness = std::numeric_limits<double>::infinity();  ///< of its middle, both sides together [N/m]
};

/// Fingers that go to an opening at a speed, and stop where an object pushes back with the force that is
/// allowed.
class Fingers {
 public:
  explicit Fingers(double opening) : most_(opening), opening_(opening), goal_(opening) {}

  void go(double opening, double force, double speed) {
    goal_ = std::clamp(opening, 0.0, most_);
    force_ = std::max(force, 0.0);
    speed_ = std::max(speed, 0.0);
  }
  void halt() { goal_ = opening_; }
  void put(const Object& object) { object_ = object; }

  void step(double dt) {
    const double next = opening_ + std::clamp(goal_ - opening_, -speed_ * dt, speed_ * dt);
    // Fingers that an object holds apart do not move.
    opening_ = next < opening_ && object_.width > 0 ? std::max(next, std::min(squeezed(), opening_)) : next;
  }

  [[nodiscard]] double opening() const { return opening_; }
  [[nodiscard]] bool moving() const { return std::abs(goal_ - opening_) > 1e-9 && !holding(); }
  /// They want to close further, and something is in the way.
  [[nodiscard]] bool holding() const {
    return goal_ < opening_ - 1e-9 && object_.width > 0 && opening_ <= squeezed() + 1e-9;
  }
  /// With which both push [N].
  [[nodiscard]] double force() const {
    const double depth = object_.width - opening_;
    if (object_.width <= 0 || depth < 0) return 0;
    return std::isinf(object_.stiffness) ? (holding() ? force_ : 0.0)
                                         : std::min(object_.stiffness * depth, force_);
  }

 private:
  /// How far they close on the object.
  [[nodiscard]] double squeezed() const {
    return std::max(std::min(object_.width, most_) - force_ / object_.stiffness, 0.0);
  }

  double most_, opening_, goal_;
  double force_ = 0, speed_ = 0;
  Object object_;
};

}  // namespace simulated_gripper
