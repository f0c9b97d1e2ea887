// Joints that reach a pose of the tool, and joint speeds that make a tool's speed.
#pragma once

#include <optional>

#include "examples/simulated_ur5/geometry.hpp"

namespace simulated_ur5 {

/// A position [m] and a rotation vector, as URScript writes poses.
using Pose6 = std::array<double, 6>;

Pose pose_of(const Pose6& p);
Pose6 six_of(const Pose& pose);
/// `a` after `b`: the pose of a frame given in frame `b`.
Pose operator*(const Pose& b, const Pose& a);
Pose inverse(const Pose& pose);

/// Joints near `near` whose flange is at `pose`, to 1e-9 m and rad; nothing where Newton's steps find none.
std::optional<Joints> joints_that_reach(const Pose& pose, const Joints& near);

/// Joint speeds that come next to a speed and turn rate of the tool's point at `point` (base's frame), damped
/// near singular poses.
Joints joint_speeds(const Links& links, Vec3 point, const std::array<double, 6>& twist);

}  // namespace simulated_ur5
