// SPDX-License-Identifier: BSD-3-Clause
// One pass over a tree from the base to the tips and back: the recursion of inverse dynamics, Y_r Theta, C dq
// and related products.
#pragma once

#include "skinctl/kinematics/joint_frame.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Per-joint numbers of a recursion, read by compile-time index. `NoValues` are typed zeros: their products
/// vanish.
template <Scalar T>
struct Values {
  const T* data;
  template <std::size_t Ix>
  SKINCTL_INLINE constexpr T get() const noexcept {
    return data[Ix];
  }
};
struct NoValues {
  template <std::size_t Ix>
  SKINCTL_INLINE constexpr TypedConstant<0> get() const noexcept {
    return {};
  }
};

/// The 3 x 3 matrix `E = [alpha]x + w w_r' - (w . w_r) 1`, by rows. `E r = alpha x r + w_r x (w x r)` is the
/// acceleration, relative to the link's origin, of the point at `r`.
template <class X, class Y, class Z>
struct Spin {
  X x;
  Y y;
  Z z;

  template <class V>
  SKINCTL_INLINE constexpr auto operator*(const V& v) const noexcept {
    return Triple{dot(x, v), dot(y, v), dot(z, v)};
  }
};

/// `E` from angular velocity, reference angular velocity and reference angular acceleration.
template <class W, class R, class A>
SKINCTL_INLINE constexpr auto make_spin(const W& w, const R& r, const A& a) noexcept {
  const auto xx = w.x * r.x;
  const auto yy = w.y * r.y;
  const auto zz = w.z * r.z;
  const Triple row_x{-(yy + zz), w.x * r.y - a.z, w.x * r.z + a.y};
  const Triple row_y{w.y * r.x + a.z, -(xx + zz), w.y * r.z - a.x};
  const Triple row_z{w.z * r.x - a.y, w.z * r.y + a.x, -(xx + yy)};
  return Spin<decltype(row_x), decltype(row_y), decltype(row_z)>{row_x, row_y, row_z};
}

/// Force and moment about a link's origin, in the link's axes.
template <class F, class N>
struct ForceMoment {
  F f;
  N n;
};
template <class F, class N>
ForceMoment(F, N) -> ForceMoment<F, N>;

template <std::size_t Ix, Scalar T, RobotModel M>
SKINCTL_INLINE constexpr auto centre_of_mass(const M& model) noexcept {
  using P = LinkParameter;
  return Triple{model.template number<Ix, P::c_x, T>(), model.template number<Ix, P::c_y, T>(),
                model.template number<Ix, P::c_z, T>()};
}

/// The inertial wrench of a link: force `f = m (a + E c)` and moment `integral r x (E r) dm + c x f`. With
/// second moments S about the centre of mass the integral has the components `(E S)_zy - (E S)_yz` and so on:
/// six products when S is diagonal. C is then exactly Christoffel's, because every mass point contributes
/// `J^T dJ`.
template <std::size_t Ix, Scalar T, RobotModel M, class E, class A>
SKINCTL_INLINE constexpr auto inertial_wrench(const M& model, const E& spin, const A& a) noexcept {
  using P = LinkParameter;
  const auto number = [&]<LinkParameter K>(std::integral_constant<LinkParameter, K>)
                          SKINCTL_INLINE_LAMBDA { return model.template number<Ix, K, T>(); };
  const auto s_xx = number(std::integral_constant<LinkParameter, P::s_xx>{});
  const auto s_yy = number(std::integral_constant<LinkParameter, P::s_yy>{});
  const auto s_zz = number(std::integral_constant<LinkParameter, P::s_zz>{});
  const auto s_xy = number(std::integral_constant<LinkParameter, P::s_xy>{});
  const auto s_xz = number(std::integral_constant<LinkParameter, P::s_xz>{});
  const auto s_yz = number(std::integral_constant<LinkParameter, P::s_yz>{});
  const auto c = centre_of_mass<Ix, T>(model);
  const auto f = model.template number<Ix, P::mass, T>() * (a + spin * c);
  const Triple s_x{s_xx, s_xy, s_xz};
  const Triple s_y{s_xy, s_yy, s_yz};
  const Triple s_z{s_xz, s_yz, s_zz};
  const Triple n{dot(spin.z, s_y) - dot(spin.y, s_z), dot(spin.x, s_z) - dot(spin.z, s_x),
                 dot(spin.y, s_x) - dot(spin.x, s_y)};
  return ForceMoment{by_component(f), n + cross(c, f)};
}

/// The links of the model itself, from which the recursion computes wrenches.
template <RobotModel M>
struct ModelBodies {
  const M& model;
  template <std::size_t Ix, Scalar T, class E, class A>
  SKINCTL_INLINE constexpr auto wrench(const E& spin, const A& a) const noexcept {
    return inertial_wrench<Ix, T>(model, spin, a);
  }
};

/// The inputs and outputs of the recursion.
template <class M, class Bodies, class Angles, class V, class R, class A, class T>
struct Recursion {
  const M& model;
  Bodies bodies;
  const Angles& angles;
  V dq;
  R dq_r;
  A ddq_r;
  T* tau;
};

/// The motion of a link in its own axes: angular velocity, reference angular velocity, reference angular
/// acceleration, and reference acceleration of its origin.
template <class W, class R, class A, class L>
struct ReferenceMotion {
  W w;
  R w_r;
  A alpha;
  L a;
};
template <class W, class R, class A, class L>
ReferenceMotion(W, R, A, L) -> ReferenceMotion<W, R, A, L>;

/// The motion of link `Ix`; the parent's angular motion and the acceleration of the parent at the joint are
/// in the axes of the link.
template <std::size_t Ix, class C, class W, class R, class A, class L>
SKINCTL_INLINE constexpr auto reference_motion(const C& c, const W& w_in, const R& w_r_in, const A& alpha_in,
                                               const L& a_in) noexcept {
  using M = std::remove_cvref_t<decltype(c.model)>;
  const auto dq = c.dq.template get<Ix>();
  const auto dq_r = c.dq_r.template get<Ix>();
  const auto ddq_r = c.ddq_r.template get<Ix>();
  constexpr UnitZ z{};
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    return ReferenceMotion{by_component(w_in + dq * z), by_component(w_r_in + dq_r * z),
                           by_component(alpha_in + ddq_r * z + dq_r * cross(w_in, z)), by_component(a_in)};
  } else {
    // d/dt of v_r + w_r x r + dq_r z, with dr/dt = w x r + dq z.
    return ReferenceMotion{by_component(w_in), by_component(w_r_in), by_component(alpha_in),
                           by_component(a_in + ddq_r * z + dq * cross(w_r_in, z) + dq_r * cross(w_in, z))};
  }
}

/// Writes `tau[Ix]` from the wrench of the subtree of link `Ix`, and returns that wrench in the parent's axes
/// about the parent's origin.
template <std::size_t Ix, class C, class Frame, class Total>
SKINCTL_INLINE constexpr auto hand_down(const C& c, const Frame& frame, const Total& total) noexcept {
  using M = std::remove_cvref_t<decltype(c.model)>;
  using T = std::remove_cvref_t<decltype(*c.tau)>;
  c.tau[Ix] = M::kinds[Ix] == JointKind::revolute ? T(total.n.z) : T(total.f.z);
  const auto f = frame.to_parent(total.f);
  return ForceMoment{by_component(f), frame.to_parent(total.n) + cross(frame.p, f)};
}

/// Computes the motion of link `Ix`, adds its children's wrenches to its own, writes `tau[Ix]`, and returns
/// the wrench in the parent's axes about the parent's origin.
template <std::size_t Ix, class C, class W, class R, class A, class E, class L>
SKINCTL_INLINE constexpr auto subtree_wrench(const C& c, const W& w_parent, const R& w_r_parent,
                                             const A& alpha_parent, const E& spin_parent,
                                             const L& a_parent) noexcept {
  using M = std::remove_cvref_t<decltype(c.model)>;
  using T = std::remove_cvref_t<decltype(*c.tau)>;
  const auto frame = joint_frame<Ix>(c.model, c.angles);
  const auto m =
      reference_motion<Ix>(c, frame.to_link(w_parent), frame.to_link(w_r_parent), frame.to_link(alpha_parent),
                           frame.to_link(a_parent + spin_parent * frame.p));
  const auto spin = make_spin(m.w, m.w_r, m.alpha);
  const auto own = c.bodies.template wrench<Ix, T>(spin, m.a);
  constexpr auto carried = children<M, int(Ix)>;
  if constexpr (carried.size() == 0) {
    return hand_down<Ix>(c, frame, own);
  } else if constexpr (carried.size() == 1) {
    const auto part = subtree_wrench<carried[0]>(c, m.w, m.w_r, m.alpha, spin, m.a);
    return hand_down<Ix>(c, frame, ForceMoment{dense<T>(own.f) + part.f, dense<T>(own.n) + part.n});
  } else {
    auto f = dense<T>(own.f);
    auto n = dense<T>(own.n);
    for_each_link<carried>([&](auto child) SKINCTL_INLINE_LAMBDA {
      const auto wrench = subtree_wrench<child.value>(c, m.w, m.w_r, m.alpha, spin, m.a);
      assign(f, f + wrench.f);
      assign(n, n + wrench.n);
    });
    return hand_down<Ix>(c, frame, ForceMoment{by_component(f), by_component(n)});
  }
}

/// Runs the recursion from the motion of the base (a `ReferenceMotion`, along its axes, with minus gravity in
/// `a`) over links with the given inertias.
template <Scalar T, RobotModel M, class Bodies, class Angles, class V, class R, class A, class Motion>
SKINCTL_INLINE constexpr void run_recursion_from(const M& model, const Bodies& bodies, const Angles& angles,
                                                 const V& dq, const R& dq_r, const A& ddq_r,
                                                 const Motion& base, T* tau) noexcept {
  const Recursion<M, Bodies, Angles, V, R, A, T> c{model, bodies, angles, dq, dq_r, ddq_r, tau};
  const auto spin = make_spin(base.w, base.w_r, base.alpha);
  constexpr auto roots = children<M, -1>;
  if constexpr (roots.size() == 1) {
    static_cast<void>(subtree_wrench<roots[0]>(c, base.w, base.w_r, base.alpha, spin, base.a));
  } else {
    for_each_link<roots>([&](auto child) SKINCTL_INLINE_LAMBDA {
      static_cast<void>(subtree_wrench<child.value>(c, base.w, base.w_r, base.alpha, spin, base.a));
    });
  }
}
/// `run_recursion_from` a base that does not turn; `a0` is its acceleration (minus gravity, or typed zeros).
template <Scalar T, RobotModel M, class Bodies, class Angles, class V, class R, class A, class L>
SKINCTL_INLINE constexpr void run_recursion_over(const M& model, const Bodies& bodies, const Angles& angles,
                                                 const V& dq, const R& dq_r, const A& ddq_r, const L& a0,
                                                 T* tau) noexcept {
  const ZeroTriple zero{};
  run_recursion_from<T>(model, bodies, angles, dq, dq_r, ddq_r, ReferenceMotion{zero, zero, zero, a0}, tau);
}
/// `run_recursion_over` the model's own links.
template <Scalar T, RobotModel M, class Angles, class V, class R, class A, class L>
SKINCTL_INLINE constexpr void run_recursion(const M& model, const Angles& angles, const V& dq, const R& dq_r,
                                            const A& ddq_r, const L& a0, T* tau) noexcept {
  run_recursion_over<T>(model, ModelBodies<M>{model}, angles, dq, dq_r, ddq_r, a0, tau);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
