// Robots from URDF files. Optional: needs tinyxml2 (Debian: libtinyxml2-dev; link tinyxml2).
#pragma once

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/io/detail/urdf_reader.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

[[noreturn]] inline void fail_urdf(const Urdf& urdf, const UrdfJoint& joint, const std::string& what) {
  refuse("skinctl: " + urdf.source + ":" + std::to_string(joint.line) + ": <joint name=\"" + joint.name +
         "\">: " + what);
}

}  // namespace detail

/// Reads a URDF from memory. `source` is what messages call it.
///
/// Throws `ConfigurationError`, with source, line and element, for: no XML or a file cut off; more than 16
/// MiB; no `<robot>`; links or joints without a name, or two of one name; a joint whose parent or child link
/// is unknown; a link on two joints; a loop; more than one base; a type other than revolute, continuous,
/// prismatic, fixed; `<mimic>`; an axis without direction; a link that moves without inertia; a negative
/// mass; moments of inertia that no body has by more than `makers_density` (by less: `Urdf::warnings`);
/// anything that is no finite number.
///
/// Links without `<inertial>` may be fixed to others or be the base, whose own inertia does not matter. A
/// joint without `<limit>` has none.
[[nodiscard]] inline Urdf parse_urdf(std::string_view text, std::string source = "URDF") {
  return detail::UrdfReader(text, std::move(source)).take();
}

/// Reads a URDF file; see `parse_urdf`. Throws `ConfigurationError` for a file that cannot be read, too.
[[nodiscard]] inline Urdf read_urdf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(detail::urdf_size_limit + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  }
  if (file.bad() || (!file.eof() && text.size() <= detail::urdf_size_limit))
    refuse("skinctl: " + path + ": cannot be read");
  return parse_urdf(text, path);
}

/// The links of a model, in the order of `urdf.joints`, and by how much the frame of each is turned against
/// that of `UrdfJoint::placed`, as in `CanonicalLinks`. Throws `ConfigurationError` for a link that cannot
/// exist.
struct UrdfLinks {
  std::vector<LinkParameters<double>> links;
  std::vector<double> turn;
};
[[nodiscard]] inline UrdfLinks model_links(const Urdf& urdf) {
  const std::size_t n = urdf.joints.size();
  std::vector<int> parents;
  std::vector<JointKind> kinds;
  std::vector<PlacedLink> placed;
  for (const UrdfJoint& j : urdf.joints)
    parents.push_back(j.parent), kinds.push_back(j.kind), placed.push_back(j.placed);
  UrdfLinks out{std::vector<LinkParameters<double>>(n), std::vector<double>(n)};
  detail::canonicalise(n, parents.data(), kinds.data(), placed.data(), out.links.data(), out.turn.data());
  for (std::size_t i = 0; i < n; ++i) {
    try {
      check_link(out.links[i], makers_density);
    } catch (const ConfigurationError& e) {
      detail::fail_urdf(urdf, urdf.joints[i], e.what());
    }
  }
  return out;
}

/// The robot as a calibrated model whose shape is known when the program is compiled. Throws
/// `ConfigurationError` naming the joint in which the file differs from `Tree`, and where `model_links` does.
/// @param gravity  in the axes of the URDF's base link [m/s^2].
template <Topology Tree, Scalar T = double>
[[nodiscard]] CalibratedModel<Tree, T> calibrated_from(const Urdf& urdf,
                                                       const Xyz<double>& gravity = {0, 0, -9.81}) {
  if (urdf.joints.size() != Tree::joints)
    refuse("skinctl: " + urdf.source + ": " + std::to_string(urdf.joints.size()) +
           " joints move, the program is made for " + std::to_string(Tree::joints));
  for (std::size_t i = 0; i < Tree::joints; ++i) {
    const UrdfJoint& joint = urdf.joints[i];
    const int parent = Tree::parents[i];
    if (joint.parent != parent)
      detail::fail_urdf(urdf, joint,
                        "it is joint " + std::to_string(i) + " and the program expects it on " +
                            (parent < 0 ? std::string("the base")
                                        : "joint \"" + urdf.joints[std::size_t(parent)].name + '"'));
    if (joint.kind != Tree::kinds[i])
      detail::fail_urdf(urdf, joint,
                        std::string("the program expects a ") +
                            (Tree::kinds[i] == JointKind::revolute ? "turning" : "sliding") + " joint here");
  }
  const UrdfLinks found = model_links(urdf);
  typename CalibratedModel<Tree, T>::Links links;
  for (std::size_t i = 0; i < Tree::joints; ++i) links[i] = found.links[i].template cast<T>();
  return CalibratedModel<Tree, T>(links, {T(gravity.x), T(gravity.y), T(gravity.z)}, makers_density);
}

SKINCTL_END_NAMESPACE
