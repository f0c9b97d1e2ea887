// Robots from URDF files. Optional: needs tinyxml2 (Debian: libtinyxml2-dev; link tinyxml2).
#pragma once

#include <algorithm>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/io/detail/urdf_reader.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/tactile/named_patch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

[[noreturn]] inline void fail_urdf(const Urdf& urdf, const UrdfJoint& joint, const std::string& what) {
  refuse("skinctl: " + urdf.source + ":" + std::to_string(joint.line) + ": <joint name=\"" + joint.name +
         "\">: " + what);
}

}  // namespace detail

/// Reads a URDF from memory. `source` is its name in error texts; `options` select a part of the robot.
///
/// Throws `ConfigurationError`, with source, line and element, for:
/// - text that is no XML, is cut off, or exceeds 16 MiB; no `<robot>`;
/// - links or joints without a name, or two of one name;
/// - a joint whose parent or child link is unknown; a link on two joints; a loop; more than one base;
/// - a type other than revolute, continuous, prismatic, fixed; an axis without direction;
/// - a link that moves without mass, or turns without inertia about its axis; a negative mass;
/// - moments of inertia that no body has by more than `makers_density` (by less, or where they do not matter:
///   `Urdf::warnings`);
/// - a value that is not a finite number;
/// - options that name a link or joint that does not exist, a tip that the base does not carry, a locked
///   position outside of its joint's limits.
///
/// A joint with `<mimic>` is fixed if the joint that it follows is. If that one moves, the file is refused:
/// the joints of a model move independently.
///
/// Links without `<inertial>` may be fixed to others or be the base, whose own inertia does not matter. A
/// joint without `<limit>` has none.
[[nodiscard]] inline Urdf parse_urdf(std::string_view text, std::string source = "URDF",
                                     const UrdfOptions& options = {}) {
  return detail::UrdfReader(text, std::move(source), options).take();
}

/// Reads a URDF file; see `parse_urdf`. Also throws `ConfigurationError` for a file that cannot be read.
[[nodiscard]] inline Urdf read_urdf(const std::string& path, const UrdfOptions& options = {}) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(detail::urdf_size_limit + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  }
  if (file.bad() || (!file.eof() && text.size() <= detail::urdf_size_limit))
    refuse("skinctl: " + path + ": cannot be read");
  return parse_urdf(text, path, options);
}

/// The links of a model, in the order of `urdf.joints`. Their frames are those of `urdf.frames`' carriers: z
/// on the joint's axis, turned about it by `turn` against `UrdfJoint::placed`, as in `CanonicalLinks`. Throws
/// `ConfigurationError` for a link that cannot exist.
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

/// The robot as a calibrated model of a topology known when the program is compiled. Its `Base` is the link
/// `urdf.base`; the frame of its `Link<I>` is not that of the file's link (z is on the joint): poses in a
/// link of the file are converted by `named_link_pose` or `patch_on`. Throws `ConfigurationError` naming the
/// joint in which the file differs from `Tree`, and where `model_links` does.
///
/// @param gravity  in the axes of the URDF's base link [m/s^2].
template <Topology Tree, Scalar T = double>
[[nodiscard]] CalibratedModel<Tree, T> calibrated_from(const Urdf& urdf,
                                                       const Xyz<double>& gravity = {0, 0, -9.81}) {
  if (urdf.joints.size() != Tree::joints)
    refuse("skinctl: " + urdf.source + ": " + std::to_string(urdf.joints.size()) +
           " joints move, the program is made for " + std::to_string(Tree::joints) + ": " +
           detail::listed(urdf.joints, [](const UrdfJoint& j) { return j.name; }) +
           "; UrdfOptions choose base, tip and locked joints");
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

/// Pose of the link `Name` of the file in `Link<I>` of the model: `link_poses(model, q).get<I>()` times this
/// is the pose that the file gives the link at `q`. Throws `ConfigurationError` for a name that is not in the
/// file, and for a link that another joint carries, or none.
template <std::size_t I, FrameName Name, Scalar T = double>
[[nodiscard]] Transform<Link<I>, NamedFrame<Name>, T> named_link_pose(const Urdf& urdf) {
  const UrdfFrame& frame = urdf.frame(Name.view());
  const auto joint = [&](int i) {
    return i < 0 ? std::string("no joint")
                 : "joint " + std::to_string(i) + " (\"" + urdf.joints[std::size_t(i)].name + "\")";
  };
  if (frame.joint != static_cast<int>(I))
    refuse("skinctl: " + urdf.source + ": link \"" + frame.name + "\" is carried by " + joint(frame.joint) +
           ", the program expects it on joint " + std::to_string(I));
  return Transform<Link<I>, NamedFrame<Name>>(frame.R, frame.p).template cast<T>();
}
/// The same for a link that no joint moves, in `Base`.
template <FrameName Name, Scalar T = double>
[[nodiscard]] Transform<Base, NamedFrame<Name>, T> named_link_pose(const Urdf& urdf) {
  const UrdfFrame& frame = urdf.frame(Name.view());
  if (frame.joint >= 0)
    refuse("skinctl: " + urdf.source + ": link \"" + frame.name + "\" is carried by joint " +
           std::to_string(frame.joint) + " (\"" + urdf.joints[std::size_t(frame.joint)].name +
           "\"), the program expects it fixed to the base");
  return Transform<Base, NamedFrame<Name>>(frame.R, frame.p).template cast<T>();
}

/// A patch on the link `Name` of the file, its cells placed in the frame that the file gives that link:
/// `patch_on<2, "forearm_link">(urdf, {{1, X_NC}}, {.force = 20})`. Throws `ConfigurationError` where
/// `named_link_pose` and `Patch` do.
template <std::size_t I, FrameName Name, std::size_t N>
[[nodiscard]] Patch<I, N> patch_on(const Urdf& urdf, const NamedCell<Name> (&cells)[N],
                                   const CellGains& gains = {}) {
  return detail::place_patch<I, Name, N>(named_link_pose<I, Name>(urdf), cells, gains);
}

/// Limits of the `N` joints from `<limit lower upper velocity effort>`; a continuous joint turns without end.
/// Throws `ConfigurationError` with the joint and the number for: another number of joints, no `<limit>`, a
/// lower limit that is not below the upper one, a velocity or effort that is missing or not above 0, and
/// limits that look like degrees (`UrdfOptions::large_limits` accepts them).
///
/// @param acceleration  [rad/s^2] of every joint; a URDF has none.
template <std::size_t N, Real T = double>
[[nodiscard]] JointLimits<N, T> limits_of(const Urdf& urdf, const T& acceleration = T(40)) {
  if (urdf.joints.size() != N)
    refuse("skinctl: " + urdf.source + ": " + std::to_string(urdf.joints.size()) +
           " joints move, limits are asked for " + std::to_string(N));
  typename JointLimits<N, T>::Values v;
  for (std::size_t i = 0; i < N; ++i) {
    const UrdfJoint& j = urdf.joints[i];
    const auto check = [&](bool allowed, const std::string& what) {
      if (!allowed) detail::fail_urdf(urdf, j, what);
    };
    const auto above_zero = [&](const char* name, double x, double most, const std::string& range) {
      check(x > 0 && x <= most, std::isinf(x) ? std::string("its <limit> has no ") + name
                                              : std::string("<limit ") + name + "=\"" +
                                                    detail::urdf_number(x) + "\">, allowed: " + range);
    };
    check(j.question.empty(), j.question + "; UrdfOptions::large_limits takes it as it is");
    above_zero("velocity", j.velocity, 1e3, "> 0, <= 1000 rad/s");
    above_zero("effort", j.effort, static_cast<double>(std::numeric_limits<T>::max()), "> 0, finite N m");
    check(j.lower < j.upper, "<limit lower=\"" + detail::urdf_number(j.lower) + "\" upper=\"" +
                                 detail::urdf_number(j.upper) + "\">: it cannot move, lock it");
    v.lower[i] = T(j.lower), v.upper[i] = T(j.upper);
    v.velocity[i] = T(j.velocity), v.torque[i] = T(j.effort);
    v.acceleration[i] = acceleration;
  }
  return JointLimits<N, T>(v);
}

SKINCTL_END_NAMESPACE
