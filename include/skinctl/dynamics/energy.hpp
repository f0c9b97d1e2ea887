// SPDX-License-Identifier: BSD-3-Clause
// Energy of a moving robot.
#pragma once

#include "skinctl/dynamics/gravity.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Kinetic energy [J] of the subtree of link `Ix`, whose parent moves at `v_parent` [m/s] and `w_parent`
/// [rad/s], along the parent's axes, at its origin.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles>
SKINCTL_INLINE T subtree_kinetic_energy(const M& model, const Angles& angles, const T* dq,
                                        const Xyz<T>& v_parent, const Xyz<T>& w_parent) noexcept {
  using P = LinkParameter;
  const auto number = [&]<LinkParameter K>(std::integral_constant<LinkParameter, K>)
                          SKINCTL_INLINE_LAMBDA { return model.template number<Ix, K, T>(); };
  const auto frame = joint_frame<Ix>(model, angles);
  Xyz<T> v = dense<T>(frame.to_link(v_parent + cross(w_parent, frame.p)));
  Xyz<T> w = dense<T>(frame.to_link(w_parent));
  T& moved = M::kinds[Ix] == JointKind::revolute ? w.z : v.z;
  moved = moved + dq[Ix];
  const Xyz<T> v_c = dense<T>(v + cross(w, centre_of_mass<Ix, T>(model)));
  // I = tr(S) 1 - S: w' I w is the sum of S_ii times the squares of the other two components of w, minus the
  // products.
  const auto s_xx = number(std::integral_constant<LinkParameter, P::s_xx>{});
  const auto s_yy = number(std::integral_constant<LinkParameter, P::s_yy>{});
  const auto s_zz = number(std::integral_constant<LinkParameter, P::s_zz>{});
  const auto s_xy = number(std::integral_constant<LinkParameter, P::s_xy>{});
  const auto s_xz = number(std::integral_constant<LinkParameter, P::s_xz>{});
  const auto s_yz = number(std::integral_constant<LinkParameter, P::s_yz>{});
  const T xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  const T turning(s_xx * T(yy + zz) + s_yy * T(xx + zz) + s_zz * T(xx + yy) -
                  (s_xy * T(T(2) * w.x * w.y) + s_xz * T(T(2) * w.x * w.z) + s_yz * T(T(2) * w.y * w.z)));
  const T moving(number(std::integral_constant<LinkParameter, P::mass>{}) * dot(v_c, v_c));
  T energy = T(0.5) * (moving + turning);
  for_each_link<children<M, int(Ix)>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    energy = energy + subtree_kinetic_energy<child.value, T>(model, angles, dq, v, w);
  });
  return energy;
}

}  // namespace detail

/// Kinetic energy `1/2 dq' M dq` [J] as the sum over links of `1/2 m v_c^2 + 1/2 w . I w`: no negative terms
/// for physically possible links. Rotors are not included: see `RotorInertia`.
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE T kinetic_energy(const M& model, const JointAngles<M, T, Mask>& angles,
                                              const JointVelocity<M::joints, T>& dq) noexcept {
  const Xyz<T> zero{T(0), T(0), T(0)};
  T energy(0);
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    energy = energy + detail::subtree_kinetic_energy<child.value, T>(model, angles, dq.data, zero, zero);
  });
  return energy;
}
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE T kinetic_energy(const M& model, const JointPosition<M::joints, T>& q,
                                              const JointVelocity<M::joints, T>& dq) noexcept {
  return kinetic_energy(model, JointAngles<M, T>(model, q), dq);
}

/// Kinetic and potential energy [J], the latter zero with all mass at the base's origin. Its rate is
/// `power(tau, dq)` of the joint torques only.
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE T energy(const M& model, const JointPosition<M::joints, T>& q,
                                      const JointVelocity<M::joints, T>& dq) noexcept {
  return kinetic_energy(model, q, dq) + potential_energy(model, q);
}

SKINCTL_END_NAMESPACE
