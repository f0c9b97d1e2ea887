// Lights of cells in the images of a camera, by OpenCV: where each is, and whose.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "examples/adapters/camera/blinks.hpp"
#include "skinctl/calibration/sighting_types.hpp"

namespace camera {

struct Light {
  std::uint16_t id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double brightness = 0;  ///< sum over its pixels, of 255 each
};
struct LightSettings {
  double least = 6;     ///< brightness of a light's brightest pixel, in deviations of the images' noise
  double share = 0.25;  ///< of a pair's brightness by which its two images differ at least
  int largest = 400;    ///< pixels of a spot; what is larger is no light
};
/// What was found, and what was left out for which reason.
struct LightsFound {
  std::vector<Light> lights;
  std::size_t spots = 0, unsure = 0, misread = 0, large = 0, twice = 0;
};

/// The lights in `Blinks::images` grey images of one size (CV_8UC1) of a camera and a robot that stand still.
/// Spots are where the images of the pairs differ; the place of one is the centre of its brightness. Two
/// spots of one id: the brighter one. Throws `std::invalid_argument` for another number of images, and for
/// images of another kind or of different sizes.
[[nodiscard]] LightsFound find_lights(std::span<const cv::Mat> images, const LightSettings& s = {});

/// The pose of known points in the camera's frame, X_CamPatch, from one view of which a third may be wrong:
/// OpenCV's solvePnPRansac, refined on those that agree to 2 pixels. None with less than six that agree.
[[nodiscard]] std::optional<skinctl::FitPose> pose_in_view(const skinctl::PinholeCamera& camera,
                                                           std::span<const Eigen::Vector3d> points,
                                                           std::span<const Eigen::Vector2d> pixels);

}  // namespace camera
