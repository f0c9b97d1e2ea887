// SPDX-License-Identifier: BSD-3-Clause
// The links of a UR5 by their names and frames in the maker's ROS 2 description.
#pragma once

#include "skinctl/model/named_links.hpp"
#include "skinctl/robots/ur5.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace ur5 {

/// The links that move of the UR ROS 2 description (config/ur5/default_kinematics.yaml, BSD-3), placed in the
/// links of `ur5::Model`: their z is on the joint there as well, and most origins lie elsewhere on it.
///
/// `ur_description` for ROS 1 gives the same names to frames with other axes.
struct Ros2Links {
  static constexpr std::array<NamedLink, 7> named_links = {{
      {"shoulder_link", 0, {}, {0, 0, Description::d1}},
      {"upper_arm_link", 1, {}, {0, 0, 0}},
      {"forearm_link", 2, {}, {0, 0, 0}},
      {"wrist_1_link", 3, {}, {0, 0, Description::d4}},
      {"wrist_2_link", 4, {}, {0, 0, Description::d5}},
      {"wrist_3_link", 5, {}, {0, 0, Description::d6}},
      {"tool0", 5, {}, {0, 0, Description::d6}},
  }};
};

}  // namespace ur5

SKINCTL_END_NAMESPACE
