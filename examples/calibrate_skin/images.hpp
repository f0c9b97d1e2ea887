// What the camera sees, as images: lights that blink, under lamps and on shiny surfaces.
#pragma once

#include <string>

#include "examples/calibrate_skin/world.hpp"

namespace calibrate_skin {

/// The lights that are found in images of the simulated skin, 28 of each pose; in `said` how many, and what
/// was left out. A fifth of them is mirrored somewhere else. Throws `ConfigurationError` for an id beyond
/// 1023: a code has ten bits.
[[nodiscard]] CameraReport seen_in_images(const World& world, const std::vector<JointAngles>& stood,
                                          std::string& said);

}  // namespace calibrate_skin
