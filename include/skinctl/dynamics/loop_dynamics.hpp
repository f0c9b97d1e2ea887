// SPDX-License-Identifier: BSD-3-Clause
// Poses, Jacobians and inverse dynamics by a loop at run time, for chains whose straight-line code compiles
// slowly.
#pragma once

#include <array>

#include "skinctl/dynamics/detail/motion.hpp"
#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <Scalar T>
using DenseJointFrame = JointFrame<Turn<T, T>, Turn<T, T>, Turn<T, T>, Xyz<T>>;

/// The frames of all joints at `q`, by a loop.
template <class Tree, Real T>
void loop_frames(const CalibratedModel<Tree, T>& model, const JointPosition<Tree::joints, T>& q,
                 std::array<DenseJointFrame<T>, Tree::joints>& frames) noexcept {
  using P = LinkParameter;
  for (std::size_t i = 0; i < Tree::joints; ++i) {
    const auto& l = model.link(i);
    const Turn<T, T> gamma{l[P::cos_gamma], l[P::sin_gamma]}, alpha{l[P::cos_alpha], l[P::sin_alpha]};
    const Xyz<T> p{l[P::p_x], l[P::p_y], l[P::p_z]};
    const T position = q[i] + l[P::offset];
    if (Tree::kinds[i] == JointKind::revolute) {
      const auto turn = math::sincos(position);
      frames[i] = {gamma, alpha, Turn<T, T>{turn.cos, turn.sin}, p};
    } else {
      const Xyz<T> along = turn_z(gamma, turn_x(alpha, Xyz<T>{T(0), T(0), position}));
      frames[i] = {gamma, alpha, Turn<T, T>{l[P::cos_beta], l[P::sin_beta]}, p + along};
    }
  }
}

}  // namespace detail

/// Pose of every link in the base: axes and origin.
template <std::size_t N, Scalar T = double>
struct LoopPoses {
  std::array<Rotation<T>, N> axes;
  std::array<Xyz<T>, N> origin;
};

/// The poses of all links, as `link_poses`, by a loop over the topology: compile time does not depend on the
/// number of joints, but zeros of the model are not used. For chains beyond some 20 joints.
template <class Tree, Real T>
[[nodiscard]] LoopPoses<Tree::joints, T> loop_poses(const CalibratedModel<Tree, T>& model,
                                                    const JointPosition<Tree::joints, T>& q) noexcept {
  std::array<detail::DenseJointFrame<T>, Tree::joints> frames;
  detail::loop_frames(model, q, frames);
  LoopPoses<Tree::joints, T> X;
  for (std::size_t i = 0; i < Tree::joints; ++i) {
    const auto& f = frames[i];
    const Xyz<T> x{T(1), T(0), T(0)}, y{T(0), T(1), T(0)}, z{T(0), T(0), T(1)};
    const Rotation<T> own{f.to_parent(x), f.to_parent(y), f.to_parent(z)};
    if (Tree::parents[i] < 0) {
      X.axes[i] = own;
      X.origin[i] = f.p;
    } else {
      const auto up = static_cast<std::size_t>(Tree::parents[i]);
      X.axes[i] = X.axes[up] * own;
      X.origin[i] = X.origin[up] + X.axes[up] * f.p;
    }
  }
  return X;
}

/// Columns of a geometric Jacobian along the axes of the base; those of joints that do not move the body are
/// zero.
template <std::size_t N, Scalar T = double>
struct LoopJacobian {
  std::array<Xyz<T>, N> linear{};   ///< velocity of the point per velocity of a joint [m/rad] or [1]
  std::array<Xyz<T>, N> angular{};  ///< angular velocity per velocity of a joint [1], or 0
};

/// The Jacobian, in the base, of the point `p` [m] (in the base) of link `link` (< joints).
template <class Tree, Scalar T>
[[nodiscard]] LoopJacobian<Tree::joints, T> loop_jacobian(const LoopPoses<Tree::joints, T>& X,
                                                          std::size_t link, const Xyz<T>& p) noexcept {
  SKINCTL_EXPECTS(link < Tree::joints, "loop_jacobian: the tree has no such link");
  LoopJacobian<Tree::joints, T> J;
  for (int i = static_cast<int>(link); i >= 0; i = Tree::parents[static_cast<std::size_t>(i)]) {
    const auto k = static_cast<std::size_t>(i);
    const Xyz<T>& z = X.axes[k].z;
    if (Tree::kinds[k] == JointKind::revolute) {
      J.linear[k] = cross(z, p - X.origin[k]);
      J.angular[k] = z;
    } else {
      J.linear[k] = z;
    }
  }
  return J;
}

/// `M ddq_r + C dq_r + G` [N m], as `yr_theta`, by a loop over the topology; inverse dynamics with `dq_r =
/// dq`.
template <class Tree, Real T>
[[nodiscard]] JointTorque<Tree::joints, T> loop_yr_theta(
    const CalibratedModel<Tree, T>& model, const JointPosition<Tree::joints, T>& q,
    const JointVelocity<Tree::joints, T>& dq, const JointVelocity<Tree::joints, T>& dq_r,
    const JointAcceleration<Tree::joints, T>& ddq_r) noexcept {
  using P = LinkParameter;
  constexpr std::size_t N = Tree::joints;
  constexpr UnitZ along{};
  std::array<detail::DenseJointFrame<T>, N> frames;
  detail::loop_frames(model, q, frames);
  std::array<detail::LinkMotion<T>, N> motion;
  std::array<Xyz<T>, N> f, n;
  const detail::LinkMotion<T> base = detail::motion_of_base<T>(model);
  for (std::size_t i = 0; i < N; ++i) {
    const auto& up = Tree::parents[i] < 0 ? base : motion[static_cast<std::size_t>(Tree::parents[i])];
    detail::LinkMotion<T>& m = motion[i];
    m = detail::carried_motion(frames[i], up);
    if (Tree::kinds[i] == JointKind::revolute) {
      m.alpha = m.alpha + ddq_r[i] * along + dq_r[i] * cross(m.w, along);
      m.w = m.w + dq[i] * along;
      m.w_r = m.w_r + dq_r[i] * along;
    } else {
      m.a = m.a + ddq_r[i] * along + dq[i] * cross(m.w_r, along) + dq_r[i] * cross(m.w, along);
    }
    m.spin = detail::dense_spin(m);
    const auto& [ex, ey, ez] = m.spin;
    const auto& l = model.link(i);
    const Xyz<T> c{l[P::c_x], l[P::c_y], l[P::c_z]};
    const Xyz<T> s_x{l[P::s_xx], l[P::s_xy], l[P::s_xz]}, s_y{l[P::s_xy], l[P::s_yy], l[P::s_yz]},
        s_z{l[P::s_xz], l[P::s_yz], l[P::s_zz]};
    f[i] = l[P::mass] * (m.a + m.spin * c);
    n[i] = Xyz<T>{dot(ez, s_y) - dot(ey, s_z), dot(ex, s_z) - dot(ez, s_x), dot(ey, s_x) - dot(ex, s_y)} +
           cross(c, f[i]);
  }
  JointTorque<N, T> tau;
  for (std::size_t i = N; i-- > 0;) {
    tau[i] = Tree::kinds[i] == JointKind::revolute ? n[i].z : f[i].z;
    if (Tree::parents[i] < 0) continue;
    const auto up = static_cast<std::size_t>(Tree::parents[i]);
    const Xyz<T> force = frames[i].to_parent(f[i]);
    f[up] = f[up] + force;
    n[up] = n[up] + frames[i].to_parent(n[i]) + cross(frames[i].p, force);
  }
  return tau;
}

/// `G(q)` [N m], as `gravity_torque`, by a loop over the topology.
template <class Tree, Real T>
[[nodiscard]] JointTorque<Tree::joints, T> loop_gravity_torque(
    const CalibratedModel<Tree, T>& model, const JointPosition<Tree::joints, T>& q) noexcept {
  const JointVelocity<Tree::joints, T> rest;
  return loop_yr_theta(model, q, rest, rest, JointAcceleration<Tree::joints, T>());
}

SKINCTL_END_NAMESPACE
