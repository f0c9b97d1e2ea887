// SPDX-License-Identifier: BSD-3-Clause
// Composite rigid bodies: the mass, first and second moments of a whole subtree, passed from link to parent.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Mass, first moment h = m c and second moments S = integral r r' dm about a frame's origin, in its axes.
/// Second moments of mass rather than of inertia: they shift without a trace term.
template <class Mass, class H, class XX, class YY, class ZZ, class XY, class XZ, class YZ>
struct Composite {
  Mass mass;
  H h;
  XX xx;
  YY yy;
  ZZ zz;
  XY xy;
  XZ xz;
  YZ yz;
};
template <class Mass, class H, class XX, class YY, class ZZ, class XY, class XZ, class YZ>
Composite(Mass, H, XX, YY, ZZ, XY, XZ, YZ) -> Composite<Mass, H, XX, YY, ZZ, XY, XZ, YZ>;

template <Scalar T>
using DenseComposite = Composite<T, Xyz<T>, T, T, T, T, T, T>;

template <Scalar T, class C>
SKINCTL_INLINE constexpr DenseComposite<T> dense_composite(const C& c) noexcept {
  return {T(c.mass), dense<T>(c.h), T(c.xx), T(c.yy), T(c.zz), T(c.xy), T(c.xz), T(c.yz)};
}

/// Link `Ix` alone as a composite, about its frame's origin.
template <std::size_t Ix, Scalar T, RobotModel M>
SKINCTL_INLINE constexpr auto link_composite(const M& model) noexcept {
  using P = LinkParameter;
  const auto mass = model.template number<Ix, P::mass, T>();
  const auto c = centre_of_mass<Ix, T>(model);
  const auto h = mass * c;
  return Composite{mass,
                   by_component(h),
                   model.template number<Ix, P::s_xx, T>() + h.x * c.x,
                   model.template number<Ix, P::s_yy, T>() + h.y * c.y,
                   model.template number<Ix, P::s_zz, T>() + h.z * c.z,
                   model.template number<Ix, P::s_xy, T>() + h.x * c.y,
                   model.template number<Ix, P::s_xz, T>() + h.x * c.z,
                   model.template number<Ix, P::s_yz, T>() + h.y * c.z};
}

/// Second moments rotated about z: `Rz S Rz'`.
template <class Turn, class C>
SKINCTL_INLINE constexpr auto turn_moments_z(const Turn& t, const C& b) noexcept {
  const auto u = t.cos * b.xx - t.sin * b.xy;
  const auto v = t.cos * b.xy - t.sin * b.yy;
  const auto xx = t.cos * u - t.sin * v;
  return Composite{b.mass,
                   turn_z(t, b.h),
                   xx,
                   b.xx + b.yy - xx,
                   b.zz,
                   t.sin * u + t.cos * v,
                   t.cos * b.xz - t.sin * b.yz,
                   t.sin * b.xz + t.cos * b.yz};
}
/// Second moments rotated about x: `Rx S Rx'`.
template <class Turn, class C>
SKINCTL_INLINE constexpr auto turn_moments_x(const Turn& t, const C& b) noexcept {
  const auto u = t.cos * b.yy - t.sin * b.yz;
  const auto v = t.cos * b.yz - t.sin * b.zz;
  const auto yy = t.cos * u - t.sin * v;
  return Composite{b.mass,
                   turn_x(t, b.h),
                   b.xx,
                   yy,
                   b.yy + b.zz - yy,
                   t.cos * b.xy - t.sin * b.xz,
                   t.sin * b.xy + t.cos * b.xz,
                   t.sin * u + t.cos * v};
}
/// A link plus one more subtree, which is given in the frame that `frame` places in the link. Terms that do
/// not depend on the subtree's motion are summed first, so that the critical path from the tips to the base
/// has two operations a link besides the rotations.
template <class Own, class Frame, class C>
SKINCTL_INLINE constexpr auto carrying(const Own& own, const Frame& frame, const C& subtree) noexcept {
  const auto b =
      turn_moments_z(frame.gamma, turn_moments_x(frame.alpha, turn_moments_z(frame.theta, subtree)));
  const auto& p = frame.p;
  const auto hp = b.mass * p;
  const auto twice = [](const auto& x, const auto& y)
                         SKINCTL_INLINE_LAMBDA { SKINCTL_CONTRACT return TypedConstant<2>{} * x + y; };
  const auto h = b.h + hp;
  return Composite{own.mass + b.mass,
                   (own.h + hp) + b.h,
                   (own.xx + b.xx) + p.x * twice(b.h.x, hp.x),
                   (own.yy + b.yy) + p.y * twice(b.h.y, hp.y),
                   (own.zz + b.zz) + p.z * twice(b.h.z, hp.z),
                   (own.xy + b.xy) + p.x * h.y + b.h.x * p.y,
                   (own.xz + b.xz) + p.x * h.z + b.h.x * p.z,
                   (own.yz + b.yz) + p.y * h.z + b.h.y * p.z};
}

}  // namespace detail
SKINCTL_END_NAMESPACE
