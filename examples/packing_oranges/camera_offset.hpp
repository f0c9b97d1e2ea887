// How far a camera is off along the table, by what hands have set down.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/core/triple.hpp"

namespace packing {

/// A belief of where things are beside where a camera sees them: a normal distribution along the table's x
/// and y. What a hand has set down lies where its fingers held it, so where the camera sees it then is a
/// measurement: a Kalman filter. Of a gripper it counts along the fingers' way only, in which closing brings
/// things to their middle.
class CameraOffset {
 public:
  using Place = skinctl::Xyz<double>;
  static constexpr double at_first =
      0.018;  ///< deviation along each axis of a camera that may be off by 25 mm [m]
  static constexpr double of_one =
      0.003;  ///< deviation of a measurement: a place that is found, and centred [m]
  /// Deviation from which it is known [m]: two measurements 45 degrees apart, each of 3 mm, leave 5.5 mm.
  static constexpr double enough = 0.006;

  /// What was believed so far may be wrong.
  constexpr void doubt() { xx_ = yy_ = at_first * at_first, xy_ = 0; }
  /// Along this unit vector a thing is `off` from where it was believed to be. Returns the change of the
  /// belief.
  [[nodiscard]] constexpr Place measure(const Place& along, double off) {
    const double x = xx_ * along.x + xy_ * along.y, y = xy_ * along.x + yy_ * along.y;
    const double sum = x * along.x + y * along.y + of_one * of_one;
    xx_ -= x * x / sum, xy_ -= x * y / sum, yy_ -= y * y / sum;
    return {x / sum * off, y / sum * off, 0};
  }
  [[nodiscard]] bool known() const {
    const double mean = (xx_ + yy_) / 2;
    return std::sqrt(mean + std::hypot((xx_ - yy_) / 2, xy_)) <= enough;
  }

 private:
  double xx_ = at_first * at_first, xy_ = 0, yy_ = at_first * at_first;
};

}  // namespace packing
