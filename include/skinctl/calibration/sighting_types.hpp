// SPDX-License-Identifier: BSD-3-Clause
// What a fit of sightings takes and gives: poses, a camera, lights.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "skinctl/calibration/estimate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A pose of a fit, `X_AB`: axes of B in A, and B's origin.
struct FitPose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  ///< axes of B in A
  Eigen::Vector3d p = Eigen::Vector3d::Zero();      ///< origin of B in A [m]

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& v) const { return R * v + p; }
  [[nodiscard]] FitPose operator*(const FitPose& X) const { return {R * X.R, R * X.p + p}; }
  [[nodiscard]] FitPose inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

/// A camera without distortion: z looks out of it, x to the right, y down.
struct PinholeCamera {
  double fx = 1000, fy = 1000, cx = 640, cy = 480;  ///< focal lengths and image centre [pixels]
};

/// A light in an image, and the cell to which it belongs by the code that it blinks. Codes are misread, and
/// lamps look like cells.
struct Sighting {
  std::size_t patch = 0, cell = 0;  ///< index of the patch, and of the cell in it
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
};
/// The lights that the camera saw at one pose of the robot.
struct CameraView {
  std::vector<FitPose> X_BaseLink;  ///< pose of each patch's link in the base
  std::vector<Sighting> seen;
};

struct SightingSettings {
  double pixel = 0.5;                  ///< standard deviation of a light's place in the image [pixels]
  double outlier_residual = 3;         ///< residual from which a sighting counts less [standard deviations]
  std::size_t refined_hypotheses = 4;  ///< hypotheses of the camera that are fitted to the end, 1 to 100
  double place_limit = 0.010;          ///< standard deviation above which a position is not observed [m]
  double turn_limit = 0.05;            ///< standard deviation above which a turn is not observed [rad]
  std::size_t min_sightings = 8;  ///< number of agreeing sightings below which a patch's pose is not observed
};

/// Result of `fit_sightings`. Covariances are of errors of position in the link's (the base's) axes [m], then
/// of the turn in the patch's (the camera's) own [rad].
struct SightingFit {
  EstimateOf<FitPose, 6> X_BaseCam;
  std::vector<EstimateOf<FitPose, 6>> X_LinkRoot;  ///< pose of each patch on its link
  std::vector<std::size_t> agreeing;  ///< agreeing sightings per patch: within `sqrt(2) outlier_residual`
  std::size_t disagreeing = 0;        ///< number of all other sightings
  double residual = 0;                ///< rms residual of the agreeing sightings along an image axis [pixels]
  std::size_t hypothesis = 0;         ///< index of the hypothesis with the lowest cost
};

SKINCTL_END_NAMESPACE
