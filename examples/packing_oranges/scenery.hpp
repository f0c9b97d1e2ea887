// What is to be seen of a run at an instant: for pages that show it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "examples/packing_oranges/layout.hpp"
#include "skinctl/clearance/capsule.hpp"

namespace packing {

struct ArmScenery {
  std::vector<skinctl::Capsule<>> parts;  ///< links and palm, where they are in the world
  std::array<skinctl::Capsule<>, 2> fingers{};
  double force = 0;        ///< of a finger [N]
  const char* step = "";   ///< of the plan
  const char* state = "";  ///< "", "goes back", "asks", "finished"
  bool touched = false;    ///< a person pushes it
  bool kept = false;       ///< limited for the other arm
  bool has_box = false;    ///< the box is its
  double stiffness = 0;    ///< that it judged last [N/m]; 0: none
  bool said_good = false;
};
struct OrangeScenery {
  skinctl::Xyz<double> p{0, 0, 0};
  double radius = 0.038;
};
struct Scenery {
  double time = 0;  ///< [s]
  std::string robot;
  std::array<ArmScenery, arms> arm;
  Trays trays = first_trays;
  std::optional<Standing> robot_stands;        ///< where a robot that drives is
  std::vector<OrangeScenery> oranges, things;  ///< things: what else moves through the room
  int box = 0, bins = 0, lost = 0, all = 0;    ///< oranges that ended there; how many there are
};

/// As JSON, without line breaks; lengths in m to the millimetre.
std::string json(const Scenery& s);
/// Box, bins and feeds.
std::string json_of_trays(const Trays& standing);

}  // namespace packing
