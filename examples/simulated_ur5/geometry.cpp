#include "examples/simulated_ur5/geometry.hpp"

#include <algorithm>
#include <utility>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

namespace simulated_ur5 {
namespace {

using Maker = skinctl::ur5::Description;

Vec3 vec3(const skinctl::Xyz<double>& v) {
  return {v.x, v.y, v.z};
}

template <std::size_t... I>
void place(const Joints& q, std::index_sequence<I...>, std::array<Pose, joint_count>& links) {
  const auto poses = skinctl::link_poses(skinctl::ur5::Model{}, skinctl::JointPosition<joint_count>(q));
  const auto pose_of = [](const auto& X_BL) {
    return Pose{vec3(X_BL.axis_x()), vec3(X_BL.axis_y()), vec3(X_BL.axis_z()), vec3(X_BL.origin())};
  };
  ((links[I] = pose_of(poses.template get<I>())), ...);
}

}  // namespace

Vec3 rotation_vector(const Pose& pose) {
  const Vec3 twice_axis{pose.y.z - pose.z.y, pose.z.x - pose.x.z, pose.x.y - pose.y.x};
  const double s = 0.5 * norm(twice_axis);
  const double c = std::clamp(0.5 * (pose.x.x + pose.y.y + pose.z.z - 1), -1.0, 1.0);
  const double angle = std::atan2(s, c);
  if (s > 1e-7) return (0.5 * angle / s) * twice_axis;
  if (c > 0) return 0.5 * twice_axis;
  // Half a turn: R = 2 n n' - 1, so the axis is any column of R + 1 that is not zero.
  const Vec3 columns[3] = {pose.x + Vec3{1, 0, 0}, pose.y + Vec3{0, 1, 0}, pose.z + Vec3{0, 0, 1}};
  const Vec3* best = std::max_element(std::begin(columns), std::end(columns),
                                      [](Vec3 a, Vec3 b) { return dot(a, a) < dot(b, b); });
  return angle * normalised(*best);
}

Links forward_kinematics(const Joints& q) {
  Links out;
  place(q, std::make_index_sequence<joint_count>(), out.link);
  out.flange = out.link[5];
  out.flange.origin = out.link[5].point({Maker::flange[0], Maker::flange[1], Maker::flange[2]});
  return out;
}

Joints torque_of_force(const Links& links, std::size_t link, Vec3 point, Vec3 force) {
  Joints torque{};
  for (std::size_t j = 0; j <= link && j < joint_count; ++j)
    torque[j] = dot(links.link[j].z, cross(point - links.link[j].origin, force));
  return torque;
}

Joints gravity_torque(const Links& links) {
  Joints torque{};
  for (std::size_t i = 0; i < joint_count; ++i) {
    using P = skinctl::LinkParameter;
    const auto& maker = Maker::links[i];
    const Vec3 centre = links.link[i].point({maker[P::c_x], maker[P::c_y], maker[P::c_z]});
    const Joints held = torque_of_force(links, i, centre, {0, 0, 9.81 * maker[P::mass]});
    for (std::size_t j = 0; j <= i; ++j) torque[j] += held[j];
  }
  return torque;
}

Vec3 point_velocity(const Links& links, std::size_t link, Vec3 point, const Joints& dq) {
  Vec3 v{};
  for (std::size_t j = 0; j <= link && j < joint_count; ++j)
    v = v + dq[j] * cross(links.link[j].z, point - links.link[j].origin);
  return v;
}

Vec3 angular_velocity(const Links& links, std::size_t link, const Joints& dq) {
  Vec3 w{};
  for (std::size_t j = 0; j <= link && j < joint_count; ++j) w = w + dq[j] * links.link[j].z;
  return w;
}

}  // namespace simulated_ur5
