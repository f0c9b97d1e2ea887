#include "examples/adapters/camera/rendered.hpp"

#include <algorithm>
#include <cmath>

namespace camera {
namespace {

void spot(cv::Mat& image, double x, double y, double brightness, double radius) {
  const int reach = static_cast<int>(std::ceil(4 * radius)), u = static_cast<int>(std::lround(x)),
            v = static_cast<int>(std::lround(y));
  for (int j = std::max(0, v - reach); j <= std::min(image.rows - 1, v + reach); ++j)
    for (int i = std::max(0, u - reach); i <= std::min(image.cols - 1, u + reach); ++i)
      image.at<float>(j, i) += static_cast<float>(
          brightness * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * radius * radius)));
}

}  // namespace

std::vector<cv::Mat> rendered(std::span<const RenderedLight> lights, const RenderSettings& s,
                              std::mt19937_64& rng) {
  const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng); };
  std::vector<RenderedLight> all(lights.begin(), lights.end());
  for (const RenderedLight& light : lights)
    if (uniform(0, 1) < s.reflected)
      all.push_back({light.id, uniform(0, s.width), uniform(0, s.height), 0.4 * light.brightness});
  std::vector<cv::Point2d> lamps;
  for (int k = 0; k < s.lamps; ++k) lamps.emplace_back(uniform(0, s.width), uniform(0, s.height));
  cv::RNG noise(rng());
  std::vector<cv::Mat> out;
  for (std::size_t k = 0; k < Blinks::images; ++k) {
    cv::Mat image(s.height, s.width, CV_32F);
    noise.fill(image, cv::RNG::NORMAL, s.background * (1 + s.flicker * uniform(-1, 1)), s.noise);
    for (const auto& lamp : lamps) spot(image, lamp.x, lamp.y, 200, 4 * s.radius);
    for (const RenderedLight& light : all)
      if (Blinks::on(light.id, k)) spot(image, light.x, light.y, light.brightness, s.radius);
    cv::Mat grey;
    image.convertTo(grey, CV_8U);  // what is brighter than white is white
    out.push_back(grey);
  }
  return out;
}

}  // namespace camera
