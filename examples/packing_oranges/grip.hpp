// How firmly a hand carries, learnt from what slipped.
#pragma once

#include <algorithm>

namespace packing {

/// The force of carrying. What was felt in the hand and is lost has slipped: from then on it holds 1.3 times
/// as much, up to a maximum. The friction is that of all oranges, so what one taught holds for the next.
class Grip {
 public:
  static constexpr double more = 1.3;  ///< two slips from a grip that is half of what is needed; a guess
  /// @param hold  force of carrying at first [N]; `max`: the largest one, below what bruises.
  constexpr Grip(double hold, double max) : hold_(std::min(hold, max)), max_(max) {}

  [[nodiscard]] constexpr double hold() const { return hold_; }
  /// Something slipped; false: it was held with the maximum, and no hand of this kind can carry it.
  constexpr bool slipped() {
    if (hold_ >= max_) return false;
    hold_ = std::min(more * hold_, max_);
    return true;
  }

 private:
  double hold_, max_;
};

}  // namespace packing
