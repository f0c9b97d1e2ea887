// Ceres behind plain arrays: sightings fitted by another solver, with derivatives by differences and rotations by their vectors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace oracle {

/// A pose: axes by rows, then the origin [m].
using PlainPose = std::array<double, 12>;

struct PlainSighting {
  PlainPose X_BaseLink{};
  std::array<double, 3> in_patch{};  ///< the light [m]
  std::array<double, 2> pixel{};
  std::size_t patch = 0;
};

/// Minimises half the sum of Cauchy losses of `width` of the lights' distances in deviations of `pixel`, from `poses`, where it
/// also leaves what it found: the camera's in the base, then the patches' on their links. False if it did not converge. The header
/// shows neither Ceres nor Eigen: ceres_oracle.cpp is built for the distribution's baseline.
/// @param camera  fx, fy, cx, cy [pixels].
bool ceres_sightings(const std::array<double, 4>& camera, const std::vector<PlainSighting>& lights,
                     double pixel, double width, std::vector<PlainPose>& poses);

}  // namespace oracle
