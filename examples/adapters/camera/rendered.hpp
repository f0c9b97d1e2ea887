// Images of blinking lights as a camera would take them: what tests and the simulated skin have instead of
// one.
#pragma once

#include <opencv2/core.hpp>
#include <random>
#include <span>
#include <vector>

#include "examples/adapters/camera/blinks.hpp"

namespace camera {

struct RenderedLight {
  std::uint16_t id = 0;
  double x = 0, y = 0;      ///< [pixels]
  double brightness = 160;  ///< of its middle, of 255
};
struct RenderSettings {
  int width = 1280, height = 960;
  double radius = 1.6;     ///< deviation of a light's spot [pixels]
  double noise = 4;        ///< deviation of a pixel, of 255
  double background = 40;  ///< mean of the room
  double flicker = 0.1;    ///< of its lamps, from image to image
  int lamps = 3;           ///< spots that are always on
  double reflected = 0;    ///< share of the lights that a shiny surface shows once more, elsewhere and dimmer
};

/// `Blinks::images` images. Lights beyond the edges are not seen; those near each other add up.
[[nodiscard]] std::vector<cv::Mat> rendered(std::span<const RenderedLight> lights, const RenderSettings& s,
                                            std::mt19937_64& rng);

}  // namespace camera
