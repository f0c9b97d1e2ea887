// The types of the table: bodies, joints, inertias as plain numbers, in any scalar; with or without fixed
// bodies.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace oracle {

/// The motion of a body in its parent, always about or along the z axis of its own frame.
enum class Motion { revolute, prismatic, fixed };

/// One body of a tree. Its frame is at `R`, `p` in the parent's frame when its joint is at zero; the joint
/// then turns it about its own z axis, `X_ParentBody = [R p] [Rz(q) 0]`, or slides it along it,
/// `X_ParentBody = [R p] [1 (0,0,q)]`.
template <class T>
struct BasicBody {
  int parent = -1;  ///< index of the parent, smaller than the own; -1: the base
  Motion motion = Motion::revolute;
  std::array<T, 9> R{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row-major
  std::array<T, 3> p{};                           ///< [m]
  T mass{};                                       ///< [kg]
  std::array<T, 3> com{};                         ///< centre of mass in the body's frame [m]
  std::array<T, 9> inertia{};  ///< about the centre of mass, in the body's axes, row-major [kg m^2]
};

/// A kinematic tree. Joints are numbered in the order of the moving bodies.
template <class T>
struct BasicRobot {
  std::vector<BasicBody<T>> bodies;
  std::array<T, 3> gravity{0, 0, T(-981) / T(100)};  ///< acceleration of free fall in the base frame [m/s^2]

  [[nodiscard]] int body_count() const { return static_cast<int>(bodies.size()); }
  [[nodiscard]] const BasicBody<T>& body(int i) const { return bodies[static_cast<std::size_t>(i)]; }

  [[nodiscard]] int joint_count() const {
    int n = 0;
    for (const auto& b : bodies) n += b.motion != Motion::fixed;
    return n;
  }
  /// Joint number of each body, -1 for bodies that are fixed to their parent.
  [[nodiscard]] std::vector<int> joints() const {
    std::vector<int> joint;
    int n = 0;
    for (const auto& b : bodies) joint.push_back(b.motion != Motion::fixed ? n++ : -1);
    return joint;
  }
  /// Whether every body is the child of the one before it.
  [[nodiscard]] bool is_chain() const {
    for (int i = 0; i < body_count(); ++i)
      if (body(i).parent != i - 1) return false;
    return true;
  }
};

using Body = BasicBody<double>;
using Robot = BasicRobot<double>;

namespace table_detail {
template <class T>
std::array<T, 9> product(const std::array<T, 9>& A, const std::array<T, 9>& B) {
  std::array<T, 9> C{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      C[3 * i + j] = A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  return C;
}
template <class T>
std::array<T, 3> product(const std::array<T, 9>& A, const std::array<T, 3>& x) {
  std::array<T, 3> y{};
  for (std::size_t i = 0; i < 3; ++i) y[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
  return y;
}
template <class T>
std::array<T, 9> transposed(const std::array<T, 9>& A) {
  return {A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]};
}
/// m (c.c 1 - c c'): the inertia of a point mass at c.
template <class T>
std::array<T, 9> point_inertia(const T& m, const std::array<T, 3>& c) {
  const T cc = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
  std::array<T, 9> I{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) I[3 * i + j] = m * ((i == j ? cc : T(0)) - c[i] * c[j]);
  return I;
}
}  // namespace table_detail

/// The same robot in another scalar. The table's numbers are taken as exact; rotations, which doubles hold to
/// 1e-16 only, become orthonormal to the precision of T (Newton: R <- R (3 - R'R)/2; exact zeros and ones
/// stay).
template <class T>
BasicRobot<T> exact(const Robot& robot) {
  using namespace table_detail;
  BasicRobot<T> result;
  for (const Body& b : robot.bodies) {
    BasicBody<T> e;
    e.parent = b.parent;
    e.motion = b.motion;
    e.mass = T(b.mass);
    for (std::size_t k = 0; k < 3; ++k) e.p[k] = T(b.p[k]), e.com[k] = T(b.com[k]);
    for (std::size_t k = 0; k < 9; ++k) e.R[k] = T(b.R[k]), e.inertia[k] = T(b.inertia[k]);
    for (int round = 0; round < 4; ++round) {
      std::array<T, 9> A = product(transposed(e.R), e.R);
      for (std::size_t k = 0; k < 9; ++k) A[k] = (T(k % 4 == 0 ? 3 : 0) - A[k]) / T(2);
      e.R = product(e.R, A);
    }
    result.bodies.push_back(e);
  }
  for (std::size_t k = 0; k < 3; ++k) result.gravity[k] = T(robot.gravity[k]);
  return result;
}

/// The same robot without fixed bodies: each is merged into the body that carries it (or dropped with the
/// base). Moving bodies keep their order.
template <class T>
BasicRobot<T> without_fixed(const BasicRobot<T>& robot) {
  using namespace table_detail;
  BasicRobot<T> result;
  result.gravity = robot.gravity;
  std::vector<int> carrier;        // body of `result` that carries body i, -1: the base
  std::vector<BasicBody<T>> pose;  // R, p of body i in its carrier
  for (const auto& b : robot.bodies) {
    const std::size_t up = static_cast<std::size_t>(b.parent);
    BasicBody<T> at;
    at.R = b.R, at.p = b.p;
    if (b.parent >= 0) {
      at.R = product(pose[up].R, b.R);
      at.p = product(pose[up].R, b.p);
      for (std::size_t k = 0; k < 3; ++k) at.p[k] += pose[up].p[k];
    }
    const int on = b.parent < 0 ? -1 : carrier[up];
    if (b.motion != Motion::fixed) {
      BasicBody<T> moved = b;
      moved.R = at.R, moved.p = at.p, moved.parent = on;
      carrier.push_back(result.body_count());
      result.bodies.push_back(moved);
      pose.push_back(BasicBody<T>{});
      continue;
    }
    carrier.push_back(on);
    pose.push_back(at);
    if (on < 0 || b.mass == T(0)) continue;
    BasicBody<T>& host = result.bodies[static_cast<std::size_t>(on)];
    std::array<T, 3> c = product(at.R, b.com), com{}, to_host{}, to_b{};
    for (std::size_t k = 0; k < 3; ++k) c[k] += at.p[k];
    const T mass = host.mass + b.mass;
    for (std::size_t k = 0; k < 3; ++k) {
      com[k] = (host.mass * host.com[k] + b.mass * c[k]) / mass;
      to_host[k] = host.com[k] - com[k];
      to_b[k] = c[k] - com[k];
    }
    const auto I = product(product(at.R, b.inertia), transposed(at.R));
    const auto I_host = point_inertia(host.mass, to_host), I_b = point_inertia(b.mass, to_b);
    for (std::size_t k = 0; k < 9; ++k) host.inertia[k] += I[k] + I_host[k] + I_b[k];
    host.mass = mass;
    host.com = com;
  }
  return result;
}

}  // namespace oracle
