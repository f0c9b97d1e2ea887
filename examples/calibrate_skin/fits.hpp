// The fits of a calibration, each compiled once: their templates take minutes.
#pragma once

#include <vector>

#include "skinctl/calibration/joint_lines_types.hpp"
#include "skinctl/calibration/reconstruction_types.hpp"
#include "skinctl/calibration/sighting_types.hpp"

namespace calibrate_skin {

/// `skinctl::reconstruct`.
[[nodiscard]] skinctl::Reconstruction fit_shape(const skinctl::PatchGraph& patch,
                                                const skinctl::RestReadings& readings,
                                                const skinctl::ReconstructionSettings& settings);
/// `skinctl::find_joint_lines`.
[[nodiscard]] skinctl::JointLines fit_lines(const skinctl::MotionRecording& recording);
/// `skinctl::fit_sightings`.
[[nodiscard]] skinctl::SightingFit fit_lights(const skinctl::PinholeCamera& camera,
                                              const std::vector<std::vector<Eigen::Vector3d>>& cells,
                                              const std::vector<std::string>& names,
                                              const std::vector<skinctl::CameraView>& views,
                                              const std::vector<skinctl::FitPose>& placed,
                                              const std::vector<skinctl::FitPose>& cameras);

}  // namespace calibrate_skin
