// A step that is taught by leading the arm: where in the box an orange is let go.
#pragma once

#include <cstdint>
#include <optional>

#include "skinctl/semantics/demonstration.hpp"

namespace packing {

struct Lesson {
  skinctl::Xyz<double> meant{0, 0, 0};   ///< where the person led the hand [m, the box's frame]
  skinctl::Xyz<double> taught{0, 0, 0};  ///< what the demonstration says
  skinctl::Xyz<double> rested{0, 0, 0};  ///< where the hand really stood when it had been left alone
  double lasted = 0;                     ///< [s]
  bool released = false;                 ///< the switch was understood as well
};

/// A simulated person leads the first arm by its hand, closed as around an orange, to a place in the box, leaves it alone
/// and presses the switch that opens it. The arm has six cells around its hand and gives way; the world is the one in
/// which it works. Nothing: the demonstration had no such goal.
[[nodiscard]] std::optional<Lesson> teach(std::uint64_t seed);

}  // namespace packing
