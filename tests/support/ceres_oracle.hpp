// Ceres behind plain arrays: sightings and patches fitted by another solver, with derivatives by differences
// and rotations by their vectors.
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

/// A patch at rest: what its cells read, and where they are joined.
struct PlainPatch {
  std::vector<std::vector<std::array<double, 3>>> readings;  ///< of each cell in each pose [g]
  struct Joint {
    std::size_t a = 0, b = 0;
    std::array<double, 3> port_a{}, port_b{};  ///< in the cells [m]
  };
  std::vector<Joint> joints;
  double reading = 0, gap = 0;                   ///< deviations [g], [m]
  double bias = 0, scale = 0, misalignment = 0;  ///< and of the sensors
};

/// Places the cells of a patch from `cells` and directions of gravity from `up`, where it also leaves what it
/// found; the first cell stays. False if it did not converge.
bool ceres_patch(const PlainPatch& patch, std::vector<PlainPose>& cells,
                 std::vector<std::array<double, 3>>& up);

/// Minimises half the sum of Cauchy losses of `width` of the lights' distances in deviations of `pixel`, from
/// `poses`, where it also leaves what it found: the camera's in the base, then the patches' on their links.
/// False if it did not converge. The header shows neither Ceres nor Eigen: ceres_oracle.cpp is built for the
/// distribution's baseline.
/// @param camera  fx, fy, cx, cy [pixels].
bool ceres_sightings(const std::array<double, 4>& camera, const std::vector<PlainSighting>& lights,
                     double pixel, double width, std::vector<PlainPose>& poses);

}  // namespace oracle
