// UR5 with an Allegro hand and 1260 cells, and the hand alone: what is offered.
#include "bench/studies/trade/offered.hpp"
#include "bench/studies/trade/scenes.hpp"

namespace trade {

std::vector<Point> hand_points() {
  auto points = offered(
      "UR5 and Allegro, 1260 cells", [](const Choices& c) { return pressed_arm_and_hand<double>(c); },
      [](const Choices& c) { return pressed_arm_and_hand<float>(c); }, true);
  for (auto& p : offered(
           "Allegro, 48 cells", [](const Choices& c) { return pressed_hand<double>(c); },
           [](const Choices& c) { return pressed_hand<float>(c); }, true))
    points.push_back(std::move(p));
  return points;
}

}  // namespace trade
