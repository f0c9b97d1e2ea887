#include "examples/calibrate_skin/wire_camera.hpp"

#include <chrono>
#include <cmath>
#include <future>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "examples/adapters/camera/lights.hpp"
#include "examples/calibrate_skin/steps.hpp"
#include "examples/calibrate_skin/wire.hpp"
#include "examples/support/text.hpp"
#include "skinctl/core/contract.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

namespace {

cv::Mat matrix(const GreyImage& image) {
  if (image.width <= 0 || image.height <= 0 ||
      image.pixels.size() != std::size_t(image.width) * std::size_t(image.height))
    throw std::runtime_error("the camera gave no image");
  cv::Mat out(image.height, image.width, CV_8UC1);
  std::copy(image.pixels.begin(), image.pixels.end(), out.data);
  return out;
}

/// Until the skin has switched its lights, and a new image shows it.
void wait_for_lights(const Options& options, const WireSkin& skin, Arm& arm) {
  constexpr double patience = 2, look = 0.016;  // [s]
  for (double waited = 0; !skin.shown(); waited += look) {
    if (waited > patience)
      throw std::runtime_error(
          "the skin does not say that it has switched its lights: its sender has to answer SKIL, see "
          "adapters/skin/PROTOCOL.md; " +
          skin.said());
    arm.stay(look);
  }
  arm.stay(options.camera_device.settle);
}

/// What `f` gives, while the arm is told to stay: it ends where it is told nothing.
template <class F>
auto meanwhile(Arm& arm, const F& f) {
  constexpr double look = 0.008;  // [s]
  auto result = std::async(std::launch::async, f);
  while (result.wait_for(std::chrono::seconds(0)) != std::future_status::ready) arm.stay(look);
  return result.get();
}

/// The images of one pose.
std::vector<cv::Mat> blinking(const Options& options, const std::vector<std::uint32_t>& ids, WireSkin& skin,
                              Arm& arm) {
  std::vector<cv::Mat> out;
  for (std::size_t k = 0; k < camera::Blinks::images; ++k) {
    std::vector<std::uint32_t> lit;
    for (const std::uint32_t id : ids)
      if (camera::Blinks::on(static_cast<std::uint16_t>(id), k)) lit.push_back(id);
    skin.show(lit);
    wait_for_lights(options, skin, arm);
    out.push_back(matrix(meanwhile(arm, options.camera_device.take)));
  }
  return out;
}

}  // namespace

Lens Lens::read(const fs::path& file) {
  const Json j = read_json(file);
  Lens out;
  try {
    out.camera = {j.at("fx").get<double>(), j.at("fy").get<double>(), j.at("cx").get<double>(),
                  j.at("cy").get<double>()};
    out.distortion = j.value("distortion", std::vector<double>());
  } catch (const Json::exception& e) {
    throw std::runtime_error(file.string() + ": a lens needs fx, fy, cx, cy (" + e.what() + ")");
  }
  for (const double f : {out.camera.fx, out.camera.fy})
    require(f > 1 && f < 1e6, "lens: fx, fy", f, "1 to 1e6");
  for (const double c : {out.camera.cx, out.camera.cy})
    require(c > -1e5 && c < 1e5, "lens: cx, cy", c, "-1e5 to 1e5");
  require(out.distortion.empty() || out.distortion.size() == 5, "lens: numbers of distortion",
          double(out.distortion.size()), "none or 5: k1, k2, p1, p2, k3");
  for (const double k : out.distortion) require(std::abs(k) < 10, "lens: distortion", k, "-10 to 10");
  return out;
}

Eigen::Vector2d Lens::straight(const Eigen::Vector2d& pixel) const {
  if (distortion.empty()) return pixel;
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<cv::Point2d> from = {{pixel.x(), pixel.y()}};
  std::vector<cv::Point2d> to;
  cv::undistortPoints(from, to, K, distortion, cv::noArray(), K);
  return {to[0].x, to[0].y};
}

struct VideoImages::Device {
  static constexpr int kept = 4;  ///< images that a driver may still have of older lights
  cv::VideoCapture video;
  bool live = false;
};
VideoImages::VideoImages(const std::string& device) : device_(std::make_shared<Device>()) {
  const bool is_number = !device.empty() && device.find_first_not_of("0123456789") == std::string::npos;
  device_->live = is_number;
  if (!(is_number ? device_->video.open(std::stoi(device)) : device_->video.open(device)))
    throw std::runtime_error("camera " + device + " cannot be opened");
}
VideoImages::~VideoImages() = default;

GreyImage VideoImages::operator()() {
  cv::Mat image, grey;
  for (int k = 0; device_->live && k < Device::kept; ++k) static_cast<void>(device_->video.grab());
  if (!device_->video.read(image) || image.empty()) throw std::runtime_error("the camera gave no image");
  if (image.channels() == 1)
    grey = image;
  else
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  if (grey.type() != CV_8UC1) throw std::runtime_error("the camera's images are not of 8 bits");
  GreyImage out{grey.cols, grey.rows, {}};
  for (int y = 0; y < grey.rows; ++y)
    out.pixels.insert(out.pixels.end(), grey.ptr(y), grey.ptr(y) + grey.cols);
  return out;
}

CameraReport seen_by_camera(const Options& options, const std::vector<std::uint32_t>& ids, WireSkin& skin,
                            Arm& arm, const std::vector<JointAngles>& poses, std::vector<JointAngles>& stood,
                            std::string& said) {
  constexpr double still = 2e-3;  // [rad]: a pixel at arm's length
  for (const std::uint32_t id : ids)
    require(id <= camera::Blinks::highest, "id of a light", double(id), "0 to 1023");
  const Lens lens = Lens::read(options.camera_device.lens);
  CameraReport out{lens.camera, {}};
  std::size_t spots = 0, unread = 0;
  for (std::size_t v = 0; v < poses.size(); ++v) {
    stood.push_back(arm.go(poses[v]).measured);
    const auto images = blinking(options, ids, skin, arm);
    const auto found = meanwhile(arm, [&] { return camera::find_lights(images); });
    const JointAngles now = arm.here();
    for (std::size_t i = 0; i < now.size(); ++i)
      if (!(std::abs(now[i] - stood[v][i]) < still))
        throw std::runtime_error("joint " + std::to_string(i) +
                                 " does not stand still while the camera looks");
    spots += found.spots, unread += found.unsure + found.misread + found.large;
    for (const auto& light : found.lights) out.lights.push_back({v, light.id, lens.straight(light.pixel)});
    options.say(text("  pose %zu of %zu: %zu lights", v + 1, poses.size(), found.lights.size()));
  }
  skin.show({});
  static_cast<void>(arm.go(options.arm.robot.home));
  said = text("  images: %zu spots in %zu views, %zu lights, %zu not read; ", spots, poses.size(),
              out.lights.size(), unread) +
         skin.said();
  return out;
}

std::vector<FitPose> cameras_by_views(const PinholeCamera& camera,
                                      const std::vector<std::vector<Eigen::Vector3d>>& cells,
                                      const std::vector<CameraView>& views,
                                      const std::vector<std::optional<FitPose>>& placed) {
  std::vector<FitPose> out;
  for (const CameraView& view : views)
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (!placed[k]) continue;
      std::vector<Eigen::Vector3d> points;
      std::vector<Eigen::Vector2d> pixels;
      for (const Sighting& s : view.seen)
        if (s.patch == k) points.push_back(cells[k][s.cell]), pixels.push_back(s.pixel);
      if (const auto X_CamPatch = camera::pose_in_view(camera, points, pixels))
        out.push_back(view.X_BaseLink[k] * *placed[k] * X_CamPatch->inverse());
    }
  return out;
}

}  // namespace calibrate_skin
