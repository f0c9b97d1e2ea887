#include "examples/calibrate_skin/fits.hpp"
#include "skinctl/calibration/sighting.hpp"

namespace calibrate_skin {

skinctl::SightingFit fit_lights(const skinctl::PinholeCamera& camera,
                                const std::vector<std::vector<Eigen::Vector3d>>& cells,
                                const std::vector<std::string>& names,
                                const std::vector<skinctl::CameraView>& views,
                                const std::vector<skinctl::FitPose>& placed,
                                const std::vector<skinctl::FitPose>& cameras) {
  return skinctl::fit_sightings(camera, cells, names, views, placed, cameras);
}

}  // namespace calibrate_skin
