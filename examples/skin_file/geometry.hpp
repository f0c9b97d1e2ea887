// What cannot be right about where a skin's cells are, though every number of its file is allowed.
#pragma once

#include <string>
#include <vector>

#include "skinctl/io/skin_placement.hpp"

namespace skin_file {

/// Faults in words, each with its patch or link: cells that coincide, metres where millimetres were meant or
/// the reverse, normals that point into the body, patches that are mirrored. Empty: nothing is known to be
/// wrong. A flat patch shows neither inward normals nor, without its neighbours' ports, a mirror.
[[nodiscard]] std::vector<std::string> geometry_faults(const skinctl::SkinFile& file,
                                                       const std::vector<skinctl::PlacedSkinPatch>& placed);

}  // namespace skin_file
