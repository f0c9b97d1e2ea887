// A skin on its robot as SVG.
#pragma once

#include <string>
#include <vector>

#include "skinctl/io/skin_placement.hpp"

namespace skin_file {

/// A robot that stands still: the pose of each link of its model in the base, and the link that carries it.
struct Pose {
  std::vector<skinctl::Rotation<double>> R;
  std::vector<skinctl::Xyz<double>> p;
  std::vector<int> parents;  ///< -1: the base
};

/// The UR5 of `ur5::Model` at `q` [rad].
Pose ur5_at(const std::vector<double>& q);
/// The robot of a URDF, in the frames of `calibrated_from`. Throws `skinctl::ConfigurationError` for another
/// number of positions than joints.
Pose urdf_at(const skinctl::Urdf& urdf, const std::vector<double>& q);

/// Two views from opposite sides, each with the cells that face the viewer in the colour of their patch;
/// those that look away are outlines, masked ones are crossed out, those of a region have a dot. Colours
/// follow the viewer's preference for light or dark.
std::string picture(const skinctl::SkinFile& file, const std::vector<skinctl::PlacedSkinPatch>& placed,
                    const Pose& pose);

}  // namespace skin_file
