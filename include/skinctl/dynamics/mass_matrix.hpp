// The mass matrix of a robot.
#pragma once

#include "skinctl/dynamics/detail/composite.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A symmetric N x N matrix that maps joint accelerations to joint torques, both triangles stored, row by
/// row. `M * ddq` is a torque; products with other kinds do not compile.
template <std::size_t N, Scalar T = double>
struct MassMatrix {
  T data[N * N] = {};

  SKINCTL_INLINE constexpr T& operator()(std::size_t i, std::size_t j) noexcept { return data[i * N + j]; }
  SKINCTL_INLINE constexpr const T& operator()(std::size_t i, std::size_t j) const noexcept {
    return data[i * N + j];
  }

  /// `M ddq` [N m].
  SKINCTL_INLINE constexpr JointTorque<N, T> operator*(const JointAcceleration<N, T>& ddq) const noexcept {
    JointTorque<N, T> tau;
    for (std::size_t i = 0; i < N; ++i) {
      T sum(0);
      for (std::size_t j = 0; j < N; ++j) sum = sum + data[i * N + j] * ddq[j];
      tau[i] = sum;
    }
    return tau;
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // M takes joint accelerations: M * ddq
  // clang-format on
};

namespace detail {

/// Wrenches that the accelerating joints of a subtree need, in the axes and about the origin of the current
/// link.
template <class T, std::size_t N>
struct JointWrenches {
  Xyz<T> f[N];
  Xyz<T> n[N];
};

/// Fills rows and columns of `M` that belong to the subtree of link `I`; leaves in `wrenches` one wrench per
/// joint of the subtree, in the parent's frame, and returns the subtree as one body in the parent's frame.
template <std::size_t I, Scalar T, Model M, class Angles>
SKINCTL_INLINE constexpr auto subtree_mass(const M& model, const Angles& angles, MassMatrix<M::joints, T>& m,
                                           JointWrenches<T, M::joints>& wrenches) noexcept {
  const auto frame = joint_frame<I>(model, angles);
  const auto body = [&]() SKINCTL_INLINE_LAMBDA {
    const auto own = link_composite<I, T>(model);
    if constexpr (children<M, int(I)>.size() == 0) {
      return own;
    } else {
      auto sum = dense_composite<T>(own);
      for_each_link<children<M, int(I)>>([&](auto child) SKINCTL_INLINE_LAMBDA {
        const auto part = subtree_mass<child.value, T>(model, angles, m, wrenches);
        sum = dense_composite<T>(Composite{sum.mass + part.mass, sum.h + part.h, sum.xx + part.xx,
                                           sum.yy + part.yy, sum.zz + part.zz, sum.xy + part.xy,
                                           sum.xz + part.xz, sum.yz + part.yz});
      });
      return sum;
    }
  }();

  // Unit acceleration of joint I alone, and what joints further out ask of joint I.
  constexpr bool revolute = M::kinds[I] == JointKind::revolute;
  const auto pass_up = [&](const auto& f, const auto& n, std::size_t k) SKINCTL_INLINE_LAMBDA {
    const auto f_parent = frame.to_parent(f);
    wrenches.f[k] = dense<T>(f_parent);
    wrenches.n[k] = dense<T>(frame.to_parent(n) + cross(frame.p, f_parent));
  };
  constexpr LinkMask carried = subtree<M>(I) & ~link_bit<I>;
  [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
    const auto one = [&](auto k) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t joint = k.value;
      if constexpr ((carried >> joint) & 1u) {
        const T coupling = revolute ? wrenches.n[joint].z : wrenches.f[joint].z;
        m(I, joint) = coupling;
        m(joint, I) = coupling;
        if constexpr (M::parents[I] >= 0) pass_up(wrenches.f[joint], wrenches.n[joint], joint);
      }
    };
    (one(std::integral_constant<std::size_t, K>{}), ...);
  }(std::make_index_sequence<M::joints>{});
  if constexpr (revolute) {
    const auto inertia = body.xx + body.yy;
    m(I, I) = T(inertia);
    if constexpr (M::parents[I] >= 0)
      pass_up(Triple{-body.h.y, body.h.x, Known<0>{}}, Triple{-body.xz, -body.yz, inertia}, I);
  } else {
    m(I, I) = T(body.mass);
    if constexpr (M::parents[I] >= 0)
      pass_up(Triple{Known<0>{}, Known<0>{}, body.mass}, Triple{body.h.y, -body.h.x, Known<0>{}}, I);
  }
  return composite_to_parent(frame, body);
}

}  // namespace detail

/// `M(q)` [kg m^2], symmetric positive definite for links with mass: the composite-rigid-body recursion in
/// link frames, where an entry is simply the z component of a moment. Joints in different branches do not
/// couple: those entries are exact zeros. Relative error a few units in the last place times the depth, of
/// the largest entry.
template <Model M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE MassMatrix<M::joints, T> mass_matrix(
    const M& model, const JointAngles<M, T, Mask>& angles) noexcept {
  MassMatrix<M::joints, T> m;
  detail::JointWrenches<T, M::joints> wrenches;
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    static_cast<void>(detail::subtree_mass<child.value, T>(model, angles, m, wrenches));
  });
  return m;
}
template <Model M, Scalar T>
[[nodiscard]] SKINCTL_INLINE MassMatrix<M::joints, T> mass_matrix(
    const M& model, const JointPosition<M::joints, T>& q) noexcept {
  return mass_matrix(model, JointAngles<M, T>(model, q));
}

SKINCTL_END_NAMESPACE
