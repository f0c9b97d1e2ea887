// SPDX-License-Identifier: BSD-3-Clause
// Mass matrix and forward dynamics by a loop at run time, for chains whose straight-line code compiles
// slowly.
#pragma once

#include "skinctl/dynamics/detail/composite.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/loop_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M(q)`, as `mass_matrix`, by a loop over the topology.
template <class Tree, Real T>
[[nodiscard]] MassMatrix<Tree::joints, T> loop_mass_matrix(const CalibratedModel<Tree, T>& model,
                                                           const JointPosition<Tree::joints, T>& q) noexcept {
  using P = LinkParameter;
  constexpr std::size_t N = Tree::joints;
  std::array<detail::DenseJointFrame<T>, N> frames;
  detail::loop_frames(model, q, frames);
  std::array<detail::DenseComposite<T>, N> bodies;
  for (std::size_t i = 0; i < N; ++i) {
    const auto& l = model.link(i);
    const Xyz<T> c{l[P::c_x], l[P::c_y], l[P::c_z]}, h = l[P::mass] * c;
    bodies[i] = {l[P::mass],
                 h,
                 l[P::s_xx] + h.x * c.x,
                 l[P::s_yy] + h.y * c.y,
                 l[P::s_zz] + h.z * c.z,
                 l[P::s_xy] + h.x * c.y,
                 l[P::s_xz] + h.x * c.z,
                 l[P::s_yz] + h.y * c.z};
  }
  MassMatrix<N, T> m;
  for (std::size_t i = N; i-- > 0;) {
    const auto& b = bodies[i];
    // The wrench of a unit acceleration of joint i alone, transformed down to the base.
    const bool turns = Tree::kinds[i] == JointKind::revolute;
    Xyz<T> f = turns ? Xyz<T>{-b.h.y, b.h.x, T(0)} : Xyz<T>{T(0), T(0), b.mass};
    Xyz<T> n = turns ? Xyz<T>{-b.xz, -b.yz, b.xx + b.yy} : Xyz<T>{b.h.y, -b.h.x, T(0)};
    m(i, i) = turns ? n.z : f.z;
    for (std::size_t k = i; Tree::parents[k] >= 0;) {
      const auto up = static_cast<std::size_t>(Tree::parents[k]);
      f = frames[k].to_parent(f);
      n = frames[k].to_parent(n) + cross(frames[k].p, f);
      m(up, i) = m(i, up) = Tree::kinds[up] == JointKind::revolute ? n.z : f.z;
      k = up;
    }
    if (Tree::parents[i] < 0) continue;
    auto& up = bodies[static_cast<std::size_t>(Tree::parents[i])];
    up = detail::carrying(up, frames[i], b);
  }
  return m;
}

/// `M^-1 (tau - C dq - G)`, as `forward_dynamics`, by a loop over the topology; a joint whose pivot is not
/// positive is removed, see `MassFactors`.
template <class Tree, Real T>
[[nodiscard]] ForwardDynamics<Tree::joints, T> loop_forward_dynamics(
    const CalibratedModel<Tree, T>& model, const JointPosition<Tree::joints, T>& q,
    const JointVelocity<Tree::joints, T>& dq, const JointTorque<Tree::joints, T>& tau) noexcept {
  constexpr std::size_t N = Tree::joints;
  const auto parent = [](std::size_t i) { return Tree::parents[i]; };
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  const JointTorque<N, T> free = tau - loop_yr_theta(model, q, dq, dq, JointAcceleration<N, T>());
  MassMatrix<N, T> l = loop_mass_matrix(model, q);
  ForwardDynamics<N, T> out;
  auto& x = out.acceleration;
  T inverse[N];
  // M = L' D L from the tips to the base; only entries between a joint and its ancestors are not zero.
  for (std::size_t k = N; k-- > 0;) {
    const bool positive = l(k, k) > T(0);
    out.positive_definite = out.positive_definite && positive;
    inverse[k] = positive ? T(1) / l(k, k) : T(0);
    for (int i = parent(k); i >= 0; i = parent(at(i))) {
      const T a = l(k, at(i)) * inverse[k];
      for (int j = i; j >= 0; j = parent(at(j))) l(at(i), at(j)) = l(at(i), at(j)) - a * l(k, at(j));
      l(k, at(i)) = a;
    }
    x[k] = free[k];
  }
  for (std::size_t k = N; k-- > 0;)
    for (int j = parent(k); j >= 0; j = parent(at(j))) x[at(j)] = x[at(j)] - l(k, at(j)) * x[k];
  for (std::size_t k = 0; k < N; ++k) {
    x[k] = x[k] * inverse[k];
    for (int j = parent(k); j >= 0; j = parent(at(j))) x[k] = x[k] - l(k, at(j)) * x[at(j)];
  }
  return out;
}

SKINCTL_END_NAMESPACE
