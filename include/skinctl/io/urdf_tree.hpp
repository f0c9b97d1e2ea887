// SPDX-License-Identifier: BSD-3-Clause
// The contents of a URDF. Needs no parser: that is in `io/urdf.hpp`.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The part of a URDF that becomes the model, and the positions of its locked joints.
struct UrdfOptions {
  /// The link that is the base of the model; empty: the root. Links that it does not carry are left out.
  std::string base{};
  /// The last link of a chain; empty: all joints move. Joints beside the chain from `base` to `tip` are
  /// locked at 0, or at the position in `locked`. Their links keep their mass: the chain carries them.
  std::string tip{};
  /// Locked joints, by name, and their positions [rad] or [m]. A joint that mimics one of them is locked too,
  /// at the position that its `<mimic>` gives.
  std::map<std::string, double, std::less<>> locked{};
  /// Accepts limits beyond two turns and speeds beyond 60 rad/s, which otherwise count as degrees.
  bool large_limits = false;
  /// Mass of all links that move [kg], from the maker's data sheet; 0: unknown. Its part that the file does
  /// not give is spread over the links without mass: by the volume of their collision shapes if all of these
  /// are boxes, cylinders and spheres, otherwise as cylinders from joint to joint with a share of `length *
  /// reach^(2/3)`, reach being the length that the joint carries. The model stays refused by torque.
  double total_mass = 0;
};

/// A joint of a URDF that moves, and the link that it carries with all links fixed to it.
struct UrdfJoint {
  std::string name;
  std::string link;  ///< name of the link that the joint carries
  int parent = -1;   ///< index of the joint that carries the parent link; -1: the base
  JointKind kind = JointKind::revolute;
  bool continuous = false;                                  ///< whether it turns without end: no limits
  double lower = -std::numeric_limits<double>::infinity();  ///< lower position limit [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();
  double velocity = std::numeric_limits<double>::infinity();  ///< largest velocity [rad/s] or [m/s]
  double effort = std::numeric_limits<double>::infinity();    ///< largest torque [N m] or force [N]
  /// Lower position limit of `<safety_controller>` [rad] or [m].
  double soft_lower = -std::numeric_limits<double>::infinity();
  double soft_upper = std::numeric_limits<double>::infinity();
  std::string question{};  ///< the limit that looks like degrees, in words; empty: none
  PlacedLink placed;       ///< place in the parent joint's frame, with z turned onto the joint's axis
  int line = 0;            ///< line of the file
};

/// The place of a link of a URDF, moving or fixed, in the model: `X_LU`, the pose of its frame in the file in
/// `Link<joint>` of `calibrated_from`'s model, or in `Base`.
struct UrdfFrame {
  std::string name;
  int joint = -1;  ///< index into `Urdf::joints` of the joint that carries the link; -1: nothing moves it
  Rotation<double> R;
  Xyz<double> p{0, 0, 0};
};

/// A joint that is locked by the options, or by a locked joint that it mimics.
struct UrdfLock {
  std::string joint;
  double position = 0;  ///< position at which the joint is locked [rad] or [m]
};

/// A link to which the file gives no mass, or none about its joint's axis, and the mass that it has in the
/// model.
struct UrdfAssumedMass {
  std::string link;
  double mass = 0;  ///< estimated from `UrdfOptions::total_mass`, or the file's [kg]
};

/// The contents of a URDF, the bodies of fixed joints merged into their carriers. Joints are in the order of
/// a walk down the tree that takes children as the file lists their joints, so parents come first.
struct Urdf {
  std::string source;  ///< the file's name, for messages
  std::string name;
  std::string base;  ///< the link whose frame is `Base` of the model
  std::vector<UrdfJoint> joints;
  std::vector<UrdfFrame> frames;                ///< every link of the model's part of the file
  std::vector<UrdfLock> locked;                 ///< joints that are locked though the file lets them move
  std::vector<UrdfAssumedMass> assumed_masses;  ///< not empty: a robot by torque is refused with this model
  /// Faults for which the file is not refused: bodies that no density makes, bad inertias of links that do
  /// not move or have very little weight, one line each; limits that look like degrees, soft limits, links
  /// without mass, one line a file.
  std::vector<std::string> warnings;

  /// The frame of the link named `link`. Throws `ConfigurationError` for an unknown one, with the known
  /// names.
  [[nodiscard]] const UrdfFrame& frame(std::string_view link) const;
};

namespace detail {

/// Names in an error text: `"a", "b", "c" and 4 more`.
template <class Range, class Name>
[[nodiscard]] std::string listed(const Range& range, const Name& name) {
  std::string text;
  std::size_t left = range.size();
  for (const auto& item : range) {
    if (text.size() > 120) return text + " and " + std::to_string(left) + " more";
    text += (text.empty() ? "\"" : ", \"") + std::string(name(item)) + '"';
    --left;
  }
  return text;
}

}  // namespace detail

inline const UrdfFrame& Urdf::frame(std::string_view link) const {
  for (const UrdfFrame& f : frames)
    if (f.name == link) return f;
  refuse("skinctl: " + source + ": no link \"" + std::string(link) + "\" below the base \"" + base +
         "\"; there are " + detail::listed(frames, [](const UrdfFrame& f) { return f.name; }));
}

SKINCTL_END_NAMESPACE
