// SPDX-License-Identifier: BSD-3-Clause
// Generalised momentum and its rate without torques, in one pass: what collision observers compare.
#pragma once

#include "skinctl/dynamics/gravity.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace kind {
struct Momentum {};  ///< generalised momentum [N m s], [N s]
}  // namespace kind

template <std::size_t N, Scalar T = double>
using JointMomentum = JointVector<kind::Momentum, N, T>;

/// `p = M dq` [N m s] and `drift = C' dq - G` [N m], so that `dp/dt = tau + drift` with the torques `tau` of
/// motors and contacts together.
template <std::size_t N, Scalar T = double>
struct MomentumRate {
  JointMomentum<N, T> momentum;
  JointTorque<N, T> drift;
};

namespace detail {

/// Momentum of the subtree of link `Ix`, about the origin and along the axes of its parent. `p` and `c` get
/// the subtree's momenta and `C' dq`.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles>
SKINCTL_INLINE void subtree_momentum(const M& model, const Angles& angles, const T* dq,
                                     const Xyz<T>& v_parent, const Xyz<T>& w_parent, Xyz<T>& linear_sum,
                                     Xyz<T>& angular_sum, T* p, T* c) noexcept {
  using P = LinkParameter;
  const auto number = [&]<LinkParameter K>(std::integral_constant<LinkParameter, K>)
                          SKINCTL_INLINE_LAMBDA { return T(model.template number<Ix, K, T>()); };
  const auto frame = joint_frame<Ix>(model, angles);
  Xyz<T> v = dense<T>(frame.to_link(v_parent + cross(w_parent, frame.p)));
  Xyz<T> w = dense<T>(frame.to_link(w_parent));
  T& moved = M::kinds[Ix] == JointKind::revolute ? w.z : v.z;
  moved = moved + dq[Ix];

  const Xyz<T> centre = dense<T>(centre_of_mass<Ix, T>(model));
  Xyz<T> linear = number(std::integral_constant<LinkParameter, P::mass>{}) * (v + cross(w, centre));
  // I = tr(S) 1 - S, about the centre of mass.
  const T s_xx = number(std::integral_constant<LinkParameter, P::s_xx>{});
  const T s_yy = number(std::integral_constant<LinkParameter, P::s_yy>{});
  const T s_zz = number(std::integral_constant<LinkParameter, P::s_zz>{});
  const T s_xy = number(std::integral_constant<LinkParameter, P::s_xy>{});
  const T s_xz = number(std::integral_constant<LinkParameter, P::s_xz>{});
  const T s_yz = number(std::integral_constant<LinkParameter, P::s_yz>{});
  Xyz<T> angular{T((s_yy + s_zz) * w.x - s_xy * w.y - s_xz * w.z),
                 T((s_xx + s_zz) * w.y - s_xy * w.x - s_yz * w.z),
                 T((s_xx + s_yy) * w.z - s_xz * w.x - s_yz * w.y)};
  angular = angular + cross(centre, linear);
  for_each_link<children<M, int(Ix)>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    subtree_momentum<child.value, T>(model, angles, dq, v, w, linear, angular, p, c);
  });

  // d(1/2 dq' M dq)/dq_I = C' dq: the momentum of the subtree paired with the link's velocity crossed with
  // the joint's axis.
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    p[Ix] = angular.z;
    c[Ix] = w.y * angular.x - w.x * angular.y + v.y * linear.x - v.x * linear.y;
  } else {
    p[Ix] = linear.z;
    c[Ix] = w.y * linear.x - w.x * linear.y;
  }
  const Xyz<T> outside = dense<T>(frame.to_parent(linear));
  linear_sum = linear_sum + outside;
  angular_sum = angular_sum + dense<T>(frame.to_parent(angular)) + dense<T>(cross(frame.p, outside));
}

}  // namespace detail

/// `p` and `C' dq - G` at a state. C is Christoffel's: `dM/dt = C + C'`. Rotors are not included: their
/// momentum is their inertia times dq, and they add nothing to the drift.
template <RobotModel M, Scalar T>
[[nodiscard]] MomentumRate<M::joints, T> momentum_rate(const M& model, const JointPosition<M::joints, T>& q,
                                                       const JointVelocity<M::joints, T>& dq) noexcept {
  MomentumRate<M::joints, T> out;
  const JointAngles<M, T> angles(model, q);
  const Xyz<T> zero{T(0), T(0), T(0)};
  Xyz<T> linear = zero, angular = zero;
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    detail::subtree_momentum<child.value, T>(model, angles, dq.data, zero, zero, linear, angular,
                                             out.momentum.data, out.drift.data);
  });
  out.drift = out.drift - gravity_torque(model, angles);
  return out;
}

SKINCTL_END_NAMESPACE
