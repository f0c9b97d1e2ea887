// A robot's description as C++: what `urdf_to_model` writes.
#pragma once

#include <string>

#include "skinctl/io/urdf.hpp"

namespace urdf_to_model {

struct Settings {
  /// Of the header, `a` or `a::b`; empty: made from the robot's name, whatever characters that has.
  std::string name_space{};
  double gravity[3] = {0, 0, -9.81};  ///< in the axes of the URDF's base link [m/s^2]
  /// Placements whose angle is a right one to within this [rad] become exact, so that the static model folds
  /// them: files print pi/2 with 10 digits. 0 keeps the file's numbers to the last bit.
  double snap = 0;
};

/// The text of a header with the robot as a static model: `<namespace>::Description` (shape, links, names,
/// limits), `<namespace>::Model`, and `<namespace>::X_LN<"wrist_3_link">`, the pose of a link of the file in
/// the model. Links and joints keep their names, as strings: any text will do. Numbers are printed so that
/// they are read back to the last bit. Throws `skinctl::ConfigurationError` as `skinctl::model_links` does,
/// for more than 64 joints, for limits that look like degrees, and for a namespace that is no name.
std::string header(const skinctl::Urdf& urdf, const Settings& settings = {});

}  // namespace urdf_to_model
