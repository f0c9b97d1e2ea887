#include "examples/adapters/camera/lights.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace camera {
namespace {

// Takes off what the room's light changed between two images, and tells the deviation of single pixels: both
// by medians, since most pixels show nothing.
double level(cv::Mat& difference) {
  std::vector<float> values;
  for (int y = 0; y < difference.rows; y += 3)
    for (int x = 0; x < difference.cols; x += 3) values.push_back(difference.at<float>(y, x));
  const auto median = [&] {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const float room = median();
  difference -= static_cast<double>(room);
  for (float& v : values) v = std::abs(v - room);
  return std::max(0.5, 1.4826 * static_cast<double>(median()));
}

}  // namespace

LightsFound find_lights(std::span<const cv::Mat> images, const LightSettings& s) {
  if (images.size() != Blinks::images)
    throw std::invalid_argument("lights: " + std::to_string(images.size()) + " images, where " +
                                std::to_string(Blinks::images) + " are needed");
  for (const cv::Mat& image : images)
    if (image.type() != CV_8UC1 || image.size() != images[0].size() || image.empty())
      throw std::invalid_argument("lights: images are grey, of 8 bits and of one size");

  std::vector<cv::Mat> differences(Blinks::bits);
  cv::Mat all = cv::Mat::zeros(images[0].size(), CV_32F);
  double noise = 0;
  for (std::size_t k = 0; k < Blinks::bits; ++k) {
    cv::subtract(images[2 * k], images[2 * k + 1], differences[k], cv::noArray(), CV_32F);
    noise += level(differences[k]) / Blinks::bits;
    cv::accumulate(cv::abs(differences[k]), all);
  }
  all /= static_cast<double>(Blinks::bits);
  // The mean size of noise is 0.8 of its deviation; the mean over the pairs scatters by 0.6 of it over their
  // root.
  const double floor = 0.8 * noise, deviation = 0.6 * noise / std::sqrt(double(Blinks::bits));
  cv::Mat spots, labels, statistics, centres;
  cv::threshold(all, spots, floor + s.least * deviation, 255, cv::THRESH_BINARY);
  spots.convertTo(spots, CV_8U);
  const int count = cv::connectedComponentsWithStats(spots, labels, statistics, centres, 8, CV_32S);

  LightsFound out;
  std::map<std::uint16_t, Light> best;
  for (int n = 1; n < count; ++n) {
    const int area = statistics.at<int>(n, cv::CC_STAT_AREA);
    if (area < 3) continue;  // a pixel of the sensor
    ++out.spots;
    if (area > s.largest) {
      ++out.large;
      continue;
    }
    const int left = statistics.at<int>(n, cv::CC_STAT_LEFT), top = statistics.at<int>(n, cv::CC_STAT_TOP),
              right = left + statistics.at<int>(n, cv::CC_STAT_WIDTH),
              bottom = top + statistics.at<int>(n, cv::CC_STAT_HEIGHT);
    double sum = 0, x_sum = 0, y_sum = 0;
    std::vector<double> bit(Blinks::bits);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        if (labels.at<int>(y, x) != n) continue;
        const double w = static_cast<double>(all.at<float>(y, x)) - floor;
        sum += w, x_sum += w * x, y_sum += w * y;
        for (std::size_t k = 0; k < Blinks::bits; ++k)
          bit[k] += static_cast<double>(differences[k].at<float>(y, x));
      }
    double most = 0;
    for (const double b : bit) most = std::max(most, std::abs(b));
    std::uint32_t read = 0;
    bool sure = sum > 0;
    for (std::size_t k = 0; k < Blinks::bits; ++k) {
      sure = sure && std::abs(bit[k]) > s.share * most;
      read |= std::uint32_t(bit[k] > 0) << k;
    }
    const auto id = Blinks::id(read);
    if (!sure || !id) {
      ++(sure ? out.misread : out.unsure);
      continue;
    }
    const Light light{*id, {x_sum / sum, y_sum / sum}, sum};
    auto [at, is_new] = best.try_emplace(*id, light);
    if (!is_new) {
      ++out.twice;
      if (light.brightness > at->second.brightness) at->second = light;
    }
  }
  for (const auto& [id, light] : best) out.lights.push_back(light);
  return out;
}

std::optional<skinctl::FitPose> pose_in_view(const skinctl::PinholeCamera& camera,
                                             std::span<const Eigen::Vector3d> points,
                                             std::span<const Eigen::Vector2d> pixels) {
  if (points.size() != pixels.size()) throw std::invalid_argument("pose in a view: one pixel for each point");
  if (points.size() < 6) return std::nullopt;
  std::vector<cv::Point3d> object;
  std::vector<cv::Point2d> image;
  for (const auto& p : points) object.emplace_back(p.x(), p.y(), p.z());
  for (const auto& p : pixels) image.emplace_back(p.x(), p.y());
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Mat turn, place;
  std::vector<int> agree;
  if (!cv::solvePnPRansac(object, image, K, cv::noArray(), turn, place, false, 500, 2.0f, 0.999, agree,
                          cv::SOLVEPNP_EPNP) ||
      agree.size() < 6)
    return std::nullopt;
  std::vector<cv::Point3d> good;
  std::vector<cv::Point2d> seen;
  for (const int k : agree)
    good.push_back(object[static_cast<std::size_t>(k)]), seen.push_back(image[static_cast<std::size_t>(k)]);
  cv::solvePnPRefineLM(good, seen, K, cv::noArray(), turn, place);
  cv::Matx33d R;
  cv::Rodrigues(turn, R);
  skinctl::FitPose X;
  for (int i = 0; i < 3; ++i) {
    X.p(i) = place.at<double>(i);
    for (int j = 0; j < 3; ++j) X.R(i, j) = R(i, j);
  }
  return X;
}

}  // namespace camera
