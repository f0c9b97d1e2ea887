// What a URDF says of a robot. Needs no parser: `io/urdf.hpp` has that.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A joint of a URDF that moves, and the link it carries with everything that is fixed to it.
struct UrdfJoint {
  std::string name;
  std::string link;  ///< the link that it carries
  int parent = -1;   ///< index of the joint that carries its parent link; -1: the base
  JointKind kind = JointKind::revolute;
  bool continuous = false;                                  ///< turns without end: no `lower`, `upper`
  double lower = -std::numeric_limits<double>::infinity();  ///< [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();  ///< [rad/s] or [m/s]
  double effort = std::numeric_limits<double>::infinity();    ///< [N m] or [N]
  PlacedLink placed;  ///< in the parent joint's frame, with z turned onto the joint's axis
  int line = 0;       ///< where the file describes it
};

/// Where a link of a URDF, moving or fixed, stands: in the frame of the joint that carries it (the one of
/// `UrdfJoint::placed`), or in the base.
struct UrdfFrame {
  std::string name;
  int joint = -1;
  Rotation<double> R;
  Xyz<double> p{0, 0, 0};
};

/// What a URDF says of a robot, its fixed joints melted into what carries them. Joints stand in the order of
/// a walk down the tree that takes children as the file lists their joints, so parents come first.
struct Urdf {
  std::string source;  ///< the file's name, for messages
  std::string name;
  std::string base;  ///< the root link
  std::vector<UrdfJoint> joints;
  std::vector<UrdfFrame> frames;  ///< every link of the file
  std::vector<std::string>
      warnings;  ///< bodies that no density makes, within `makers_density`; one line each
};

SKINCTL_END_NAMESPACE
