// SPDX-License-Identifier: BSD-3-Clause
// Robots from URDF files. Optional: needs tinyxml2 (Debian: libtinyxml2-dev; link tinyxml2), in each file
// that includes this, or in one source of the program by CMake's `skinctl::io`.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "skinctl/io/parse_urdf.hpp"
#ifndef SKINCTL_COMPILED_IO
#include "skinctl/io/detail/parse_urdf_body.hpp"
#endif
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/tactile/named_patch.hpp"

SKINCTL_BEGIN_NAMESPACE
/// The robot as a calibrated model of a topology known when the program is compiled. Its `Base` is the link
/// `urdf.base`; the frame of its `Link<Ix>` is not that of the file's link (z is on the joint): poses in a
/// link of the file are converted by `named_link_pose` or `patch_on`. Throws `ConfigurationError` naming the
/// joint in which the file differs from `Tree`, and where `model_links` does.
///
/// @param gravity  gravity in the axes of the URDF's base link [m/s^2].
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
  CalibratedModel<Tree, T> model(links, {T(gravity.x), T(gravity.y), T(gravity.z)}, makers_density);
  if (!urdf.assumed_masses.empty()) model.assume_masses();
  return model;
}

/// Pose of the link `Name` of the file in `Link<Ix>` of the model: `link_poses(model, q).get<Ix>()` times
/// this is the pose that the file gives the link at `q`. Throws `ConfigurationError` for a name that is not
/// in the file, and for a link that another joint carries, or none.
template <std::size_t Ix, FrameName Name, Scalar T = double>
[[nodiscard]] Transform<Link<Ix>, NamedFrame<Name>, T> named_link_pose(const Urdf& urdf) {
  const UrdfFrame& frame = urdf.frame(Name.view());
  const auto joint = [&](int i) {
    return i < 0 ? std::string("no joint")
                 : "joint " + std::to_string(i) + " (\"" + urdf.joints[std::size_t(i)].name + "\")";
  };
  if (frame.joint != static_cast<int>(Ix))
    refuse("skinctl: " + urdf.source + ": link \"" + frame.name + "\" is carried by " + joint(frame.joint) +
           ", the program expects it on joint " + std::to_string(Ix));
  return Transform<Link<Ix>, NamedFrame<Name>>(frame.R, frame.p).template cast<T>();
}
/// Pose in `Base` of a link that no joint moves. Throws `ConfigurationError` for another link, and for a name
/// that is not in the file.
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
template <std::size_t Ix, FrameName Name, std::size_t N>
[[nodiscard]] Patch<Ix, N> patch_on(const Urdf& urdf, const NamedCell<Name> (&cells)[N],
                                    const CellGains& gains = {}) {
  return detail::place_patch<Ix, Name, N>(named_link_pose<Ix, Name>(urdf), cells, gains);
}

/// Limits of the `N` joints from `<limit lower upper velocity effort>`, lower and upper those of
/// `<safety_controller>` where these are narrower; a continuous joint turns without end.
/// Throws `ConfigurationError` with the joint and the number for: another number of joints, no `<limit>`, a
/// lower limit that is not below the upper one, a velocity or effort that is missing or not above 0, and
/// limits that look like degrees (`UrdfOptions::large_limits` accepts them).
///
/// @param acceleration  acceleration limit of every joint [rad/s^2], [m/s^2]; a URDF has none.
/// @param torque        largest torque of each joint [N m], [N], in place of `effort`, which files of makers
///                      have as 0.
template <std::size_t N, Real T = double>
[[nodiscard]] JointLimits<N, T> limits_of(const Urdf& urdf, const T& acceleration = T(40),
                                          const std::optional<JointTorque<N, T>>& torque = {}) {
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
    if (!torque)
      above_zero("effort", j.effort, static_cast<double>(std::numeric_limits<T>::max()),
                 "> 0, finite N m; limits_of(urdf, acceleration, torque) takes yours");
    check(j.lower < j.upper, "<limit lower=\"" + detail::urdf_number(j.lower) + "\" upper=\"" +
                                 detail::urdf_number(j.upper) + "\">: it cannot move, lock it");
    v.lower[i] = T(std::max(j.lower, j.soft_lower)), v.upper[i] = T(std::min(j.upper, j.soft_upper));
    v.velocity[i] = T(j.velocity), v.torque[i] = torque ? (*torque)[i] : T(j.effort);
    v.acceleration[i] = acceleration;
  }
  return JointLimits<N, T>(v);
}

SKINCTL_END_NAMESPACE
