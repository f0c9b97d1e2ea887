// SPDX-License-Identifier: BSD-3-Clause
// The motion of every link, from the base to the tips, with additional data of an algorithm.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The motion that determines the wrench of a link, in its own axes: `E` and `a`, where `a + E r` is the
/// acceleration of its point at r; both for the reference motion, with minus gravity in `a`.
template <Scalar T>
struct LinkMotion {
  Xyz<T> w, w_r, alpha, a;
  Spin<Xyz<T>, Xyz<T>, Xyz<T>> spin;
};

template <class M, class Angles, class T>
struct MotionInput {
  const M& model;
  const Angles& angles;
  const T* dq;
  const T* dq_r;
  const T* ddq_r;
};

/// The motion of a link as carried by its parent, before its own joint adds to it; without spin.
template <class Frame, Scalar T>
SKINCTL_INLINE LinkMotion<T> carried_motion(const Frame& frame, const LinkMotion<T>& parent) noexcept {
  return {dense<T>(frame.to_link(parent.w)),
          dense<T>(frame.to_link(parent.w_r)),
          dense<T>(frame.to_link(parent.alpha)),
          dense<T>(frame.to_link(parent.a + parent.spin * frame.p)),
          {}};
}
template <Scalar T>
SKINCTL_INLINE Spin<Xyz<T>, Xyz<T>, Xyz<T>> dense_spin(const LinkMotion<T>& m) noexcept {
  const auto spin = make_spin(m.w, m.w_r, m.alpha);
  return {dense<T>(spin.x), dense<T>(spin.y), dense<T>(spin.z)};
}

/// The motion of link `Ix` from that of its parent. Dense, so that all links of a chain have the same types.
template <std::size_t Ix, class Input, class Frame, Scalar T>
SKINCTL_INLINE LinkMotion<T> motion_of(const Input& in, const Frame& frame,
                                       const LinkMotion<T>& parent) noexcept {
  using M = std::remove_cvref_t<decltype(in.model)>;
  constexpr UnitZ z{};
  LinkMotion<T> m = carried_motion(frame, parent);
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    m.alpha = m.alpha + in.ddq_r[Ix] * z + in.dq_r[Ix] * cross(m.w, z);
    m.w = m.w + in.dq[Ix] * z;
    m.w_r = m.w_r + in.dq_r[Ix] * z;
  } else {
    m.a = m.a + in.ddq_r[Ix] * z + in.dq[Ix] * cross(m.w_r, z) + in.dq_r[Ix] * cross(m.w, z);
  }
  m.spin = dense_spin(m);
  return m;
}

/// The motion of a base at rest; gravity enters as an upward acceleration.
template <Scalar T, RobotModel M>
SKINCTL_INLINE LinkMotion<T> motion_of_base(const M& model) noexcept {
  const Xyz<T> zero{T(0), T(0), T(0)};
  return {zero, zero, zero, dense<T>(-model.template gravity<T>()), {zero, zero, zero}};
}

}  // namespace detail
SKINCTL_END_NAMESPACE
