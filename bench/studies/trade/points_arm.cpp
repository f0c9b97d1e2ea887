// UR5, bare and with 260 cells: what is offered.
#include "bench/studies/trade/offered.hpp"
#include "bench/studies/trade/scenes.hpp"

namespace trade {

std::vector<Point> arm_points() {
  auto points = offered(
      "UR5", [](const Choices& c) { return bare_arm<double>(c); },
      [](const Choices& c) { return bare_arm<float>(c); }, false);
  for (auto& p : offered(
           "UR5, 260 cells", [](const Choices& c) { return pressed_ur5<double>(c); },
           [](const Choices& c) { return pressed_ur5<float>(c); }, true))
    points.push_back(std::move(p));
  return points;
}

}  // namespace trade
