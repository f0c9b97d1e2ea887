// A camera that exists, and the lights of a skin that exists: told over the wire, looked for in its images.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "examples/calibrate_skin/arm.hpp"
#include "examples/calibrate_skin/world.hpp"

namespace calibrate_skin {

class WireSkin;

/// A camera's lens: `{"fx", "fy", "cx", "cy"}` [pixels] and, where there is any, `"distortion"`, OpenCV's
/// k1, k2, p1, p2, k3. As `cv::calibrateCamera` finds them.
struct Lens {
  skinctl::PinholeCamera camera;
  std::vector<double> distortion;
  /// Throws `std::runtime_error` for a file that cannot be read, `ConfigurationError` for numbers that no
  /// lens has.
  static Lens read(const fs::path& file);
  /// Where a camera without distortion would see it.
  [[nodiscard]] Eigen::Vector2d straight(const Eigen::Vector2d& pixel) const;
};

/// Images of a video device, as `cv::VideoCapture` names it: a number, a stream's address, a file. Throws
/// `std::runtime_error` where there is none, and where an image does not come.
class VideoImages {
 public:
  explicit VideoImages(const std::string& device);
  ~VideoImages();
  GreyImage operator()();

 private:
  struct Device;
  std::shared_ptr<Device> device_;
};

/// Goes through `poses`; in each the lights of the cells `ids` blink their code and the camera looks.
/// `stood`: where the arm was. Throws `ConfigurationError` for an id beyond a code, `std::runtime_error`
/// where the skin does not switch its lights or the arm does not stand still.
[[nodiscard]] CameraReport seen_by_camera(const Options& options, const std::vector<std::uint32_t>& ids,
                                          WireSkin& skin, Arm& arm, const std::vector<JointAngles>& poses,
                                          std::vector<JointAngles>& stood, std::string& said);

/// Where the camera may be, X_BaseCam: one for each patch and view that show it, from patches that lie at
/// `placed` (none: nobody knows).
[[nodiscard]] std::vector<skinctl::FitPose> cameras_by_views(
    const skinctl::PinholeCamera& camera, const std::vector<std::vector<Eigen::Vector3d>>& cells,
    const std::vector<skinctl::CameraView>& views,
    const std::vector<std::optional<skinctl::FitPose>>& placed);

}  // namespace calibrate_skin
