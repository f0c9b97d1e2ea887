// A robot's description as C++: what `urdf_to_model` writes.
#pragma once

#include <string>

#include "skinctl/io/urdf.hpp"

namespace urdf_to_model {

struct Settings {
  std::string name_space{};           ///< of the header; empty: made from the robot's name
  double gravity[3] = {0, 0, -9.81};  ///< in the axes of the URDF's base link [m/s^2]
  /// Placements whose angle is a right one to within this [rad] become exact, so that the static model folds
  /// them: files print pi/2 with 10 digits. 0 keeps the file's numbers to the last bit.
  double snap = 0;
};

/// The text of a header with the robot as a static model: `<namespace>::Description` (shape, links, names,
/// limits) and `<namespace>::Model`. Numbers are printed so that they are read back to the last bit. Throws
/// `skinctl::ConfigurationError` as `skinctl::model_links` does, and for more than 64 joints.
std::string header(const skinctl::Urdf& urdf, const Settings& settings = {});

}  // namespace urdf_to_model
