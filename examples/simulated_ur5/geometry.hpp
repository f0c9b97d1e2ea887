// Where the links of the simulated UR5 are: vectors, poses, forward kinematics, static torques.
#pragma once

#include <array>
#include <cmath>

namespace simulated_ur5 {

inline constexpr std::size_t joint_count = 6;
inline constexpr double pi = 3.14159265358979323846;

/// One number per joint: rad, rad/s, rad/s^2 or N m.
using Joints = std::array<double, joint_count>;

struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
};

constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) {
  return std::sqrt(dot(a, a));
}
/// `a` with length one; the z axis where `a` has no direction.
inline Vec3 normalised(Vec3 a) {
  const double n = norm(a);
  return n > 1e-12 ? (1 / n) * a : Vec3{0, 0, 1};
}

/// Axes (columns x, y, z) and origin of a frame in the base's frame.
struct Pose {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  Vec3 origin{};

  Vec3 rotate(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3 point(Vec3 p) const { return origin + rotate(p); }
  Vec3 rotate_back(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3 point_back(Vec3 p) const { return rotate_back(p - origin); }
};

/// Rotation vector (axis times angle, angle in [0, pi]) of the axes of `pose`, as URScript writes
/// orientations.
Vec3 rotation_vector(const Pose& pose);

/// Poses of link frames 0 to 5 and of the tool flange in the base's frame. The frame of link `i` is the one
/// right after `Rz(q[i])`: z on the axis of joint `i`, moving with the link.
struct Links {
  std::array<Pose, joint_count> link;
  Pose flange;
};

/// Where everything is at `q`, by skinctl's model of the UR5.
Links forward_kinematics(const Joints& q);

/// Joint torques that hold a force [N] at a point of link `link`, both in the base's frame: `J^T F`.
Joints torque_of_force(const Links& links, std::size_t link, Vec3 point, Vec3 force);

/// Joint torques [N m] that gravity asks of the motors at rest, from the maker's masses and centres of mass.
Joints gravity_torque(const Links& links);

/// Velocity [m/s] of a point of link `link` (base's frame).
Vec3 point_velocity(const Links& links, std::size_t link, Vec3 point, const Joints& dq);

/// Angular velocity [rad/s] of link `link` in the base's frame.
Vec3 angular_velocity(const Links& links, std::size_t link, const Joints& dq);

}  // namespace simulated_ur5
