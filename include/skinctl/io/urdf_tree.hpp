// What a URDF says of a robot. Needs no parser: `io/urdf.hpp` has that.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Which part of a URDF becomes the model, and where its other joints stand.
struct UrdfOptions {
  /// The link that is the base of the model; empty: the root. What is not carried by it is left out.
  std::string base{};
  /// The last link of a chain; empty: all joints move. Joints off the way from `base` to `tip` stand still at
  /// 0, or where `locked` says. The links on them keep their mass: they hang on the chain.
  std::string tip{};
  /// Joints that stand still, by name, and where [rad] or [m]. A joint that mimics one of them stands still
  /// too, at the position that its `<mimic>` gives.
  std::map<std::string, double, std::less<>> locked{};
  /// Limits beyond two turns and speeds beyond 60 rad/s are meant, and no degrees.
  bool large_limits = false;
};

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
  std::string question{};  ///< a limit that looks like degrees, in words; empty: none does
  PlacedLink placed;       ///< in the parent joint's frame, with z turned onto the joint's axis
  int line = 0;            ///< where the file describes it
};

/// Where a link of a URDF, moving or fixed, stands in the model: `X_LU`, the pose of the frame that the file
/// gives it in `Link<joint>` of `calibrated_from`'s model, or in `Base`.
struct UrdfFrame {
  std::string name;
  int joint = -1;  ///< the joint of `Urdf::joints` that carries it; -1: nothing moves it
  Rotation<double> R;
  Xyz<double> p{0, 0, 0};
};

/// A joint that does not move because the options or another joint that it mimics say so.
struct UrdfLock {
  std::string joint;
  double position = 0;  ///< [rad] or [m]
};

/// What a URDF says of a robot, its fixed joints melted into what carries them. Joints stand in the order of
/// a walk down the tree that takes children as the file lists their joints, so parents come first.
struct Urdf {
  std::string source;  ///< the file's name, for messages
  std::string name;
  std::string base;  ///< the link in whose axes the model stands: `Base`
  std::vector<UrdfJoint> joints;
  std::vector<UrdfFrame> frames;  ///< every link of the model's part of the file
  std::vector<UrdfLock> locked;   ///< joints that stand still though the file lets them move
  /// What is odd but does not matter much: bodies that no density makes (within `makers_density`), bad
  /// inertias of what does not move or weighs next to nothing, limits that look like degrees. One line each,
  /// with the link or joint.
  std::vector<std::string> warnings;

  /// Where the link `name` stands. Throws `ConfigurationError` for an unknown one, with those there are.
  [[nodiscard]] const UrdfFrame& frame(std::string_view link) const;
};

namespace detail {

/// `"a", "b", "c" and 4 more`: names for a message.
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
