#include "examples/simulated_ur5/kinematics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace simulated_ur5 {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using Matrix = Eigen::Matrix<double, 6, 6>;

/// A column is what a joint that turns does to the point: its speed (rows 0 to 2) and turn rate (3 to 5).
Matrix jacobian(const Links& links, Vec3 point) {
  Matrix J;
  for (std::size_t j = 0; j < joint_count; ++j) {
    const Vec3 w = links.link[j].z, v = cross(w, point - links.link[j].origin);
    J.col(static_cast<Eigen::Index>(j)) << v.x, v.y, v.z, w.x, w.y, w.z;
  }
  return J;
}

/// `J' (J J' + d^2)^-1 twist`.
Joints damped(const Matrix& J, const std::array<double, 6>& twist, double damping) {
  const Matrix A = J * J.transpose() + damping * damping * Matrix::Identity();
  Joints dq{};
  Eigen::Map<Six>(dq.data()) = J.transpose() * A.ldlt().solve(Eigen::Map<const Six>(twist.data()));
  return dq;
}

}  // namespace

Pose pose_of(const Pose6& p) {
  const Vec3 r{p[3], p[4], p[5]};
  const double angle = norm(r), c = std::cos(angle), s = std::sin(angle);
  const Vec3 n = normalised(r);
  const auto turned = [&](Vec3 v) { return c * v + s * cross(n, v) + ((1 - c) * dot(n, v)) * n; };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {p[0], p[1], p[2]}};
}

Pose6 six_of(const Pose& pose) {
  const Vec3 r = rotation_vector(pose), p = pose.origin;
  return {p.x, p.y, p.z, r.x, r.y, r.z};
}

Pose operator*(const Pose& b, const Pose& a) {
  return {b.rotate(a.x), b.rotate(a.y), b.rotate(a.z), b.point(a.origin)};
}

Pose inverse(const Pose& pose) {
  Pose out{pose.rotate_back({1, 0, 0}), pose.rotate_back({0, 1, 0}), pose.rotate_back({0, 0, 1}), {}};
  out.origin = -pose.rotate_back(pose.origin);
  return out;
}

std::optional<Joints> joints_that_reach(const Pose& pose, const Joints& near) {
  Joints q = near;
  for (int step = 0; step < 200; ++step) {
    const Links links = forward_kinematics(q);
    const Vec3 away = pose.origin - links.flange.origin;
    const Pose turn = pose * inverse(links.flange);
    const Vec3 turned = rotation_vector(turn);
    const double error = std::max(norm(away), norm(turned));
    if (!std::isfinite(error)) return std::nullopt;
    if (error < 1e-9) return q;
    const Joints dq =
        damped(jacobian(links, links.flange.origin), {away.x, away.y, away.z, turned.x, turned.y, turned.z},
               std::min(0.05, 0.2 * error));
    double largest = 0;
    for (const double x : dq) largest = std::max(largest, std::abs(x));
    const double share = largest > 0.3 ? 0.3 / largest : 1;
    for (std::size_t i = 0; i < joint_count; ++i) q[i] += share * dq[i];
  }
  return std::nullopt;
}

Joints joint_speeds(const Links& links, Vec3 point, const std::array<double, 6>& twist) {
  return damped(jacobian(links, point), twist, 0.01);
}

}  // namespace simulated_ur5
