// SPDX-License-Identifier: BSD-3-Clause
// Reads a URDF: what a program calls, without the parser, which is in `io/urdf.hpp` or compiled once by
// CMake's `skinctl::io`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "skinctl/io/urdf_tree.hpp"
#include "skinctl/model/link.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

[[noreturn]] void fail_urdf(const Urdf& urdf, const UrdfJoint& joint, const std::string& what);
/// A number in an error text.
[[nodiscard]] std::string urdf_number(double x);

}  // namespace detail

/// Reads a URDF from memory. `source` is its name in error texts; `options` select a part of the robot.
///
/// Throws `ConfigurationError`, with source, line and element, for:
/// - text that is no XML, is cut off, or exceeds 16 MiB; no `<robot>`; a xacro that was not expanded;
/// - links or joints without a name, or two of one name;
/// - a joint whose parent or child link is unknown; a link on two joints; a loop; more than one base;
/// - a type other than revolute, continuous, prismatic, fixed; an axis without direction;
/// - a negative mass; a `total_mass` that is not above the masses in the file;
/// - a principal moment of inertia below -1/10 of the largest (moments that violate the triangle inequality,
///   or that do not matter:
///   `Urdf::warnings`);
/// - a value that is not a finite number;
/// - options that name a link or joint that does not exist, a tip that the base does not carry, a locked
///   position outside of its joint's limits.
///
/// A joint with `<mimic>` is fixed if the joint that it follows is. If that one moves, the file is refused:
/// the joints of a model move independently.
///
/// Links without `<inertial>` may be fixed to others or be the base, whose own inertia does not matter. Where
/// a joint carries none, as in the files of stiff industrial arms, the mass is 0 or estimated (`total_mass`):
/// enough by position and velocity, where `virtual_inertia` gives the joints their inertia; by torque the
/// model is refused. Moments off by more than `makers_density` are replaced by the nearest ones that a body
/// has.
///
/// Joints beside the chain from base to tip that the fixed base carries are not looked at: neither limits nor
/// mimics of a second arm matter. A joint without `<limit>` has none.
[[nodiscard]] Urdf parse_urdf(std::string_view text, std::string source = "URDF",
                              const UrdfOptions& options = {});

/// Reads a URDF file; see `parse_urdf`. Also throws `ConfigurationError` for a file that cannot be read.
[[nodiscard]] Urdf read_urdf(const std::string& path, const UrdfOptions& options = {});

/// The links of a model, in the order of `urdf.joints`. Their frames, to which `urdf.frames` refer, have z on
/// the joint's axis and are turned about it by `turn` [rad] from those of `UrdfJoint::placed`, as in
/// `TurnedLinks`. Throws `ConfigurationError` for a link that cannot exist.
struct UrdfLinks {
  std::vector<LinkParameters<double>> links;
  std::vector<double> turn;
};
[[nodiscard]] UrdfLinks model_links(const Urdf& urdf);

SKINCTL_END_NAMESPACE
