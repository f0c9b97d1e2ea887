// SPDX-License-Identifier: BSD-3-Clause
// The centre of mass of a robot and its Jacobian.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/kinematics/poses.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Centre of mass in the base, and its Jacobian. The column of a joint that carries no mass is 0; a robot
/// without mass has the origin and zeros.
template <std::size_t N, Scalar T = double>
struct CentreOfMass {
  T mass{0};                   ///< mass of all links [kg]
  Xyz<T> p{T(0), T(0), T(0)};  ///< centre of mass in the base [m]
  /// Velocity of the centre of mass in the base, per velocity of each joint [m/rad] or [1].
  Xyz<T> columns[N]{};

  /// Velocity of the centre of mass [m/s], along the axes of the base.
  [[nodiscard]] SKINCTL_INLINE Xyz<T> velocity(const JointVelocity<N, T>& dq) const noexcept {
    Xyz<T> v{T(0), T(0), T(0)};
    for (std::size_t i = 0; i < N; ++i) v = v + dq[i] * columns[i];
    return v;
  }
  /// The Jacobian as a 3 x N matrix.
  [[nodiscard]] friend EigenMatrix<T, 3, int(N)> as_eigen(const CentreOfMass& at) noexcept {
    EigenMatrix<T, 3, int(N)> J;
    for (std::size_t i = 0; i < N; ++i) J.col(static_cast<std::ptrdiff_t>(i)) = as_eigen(at.columns[i]);
    return J;
  }
};

/// The centre of mass from the poses of all links, in one pass from the tips to the base over the mass and
/// first moment of each subtree. The torque that holds the robot against gravity is `-mass J' g`.
template <RobotModel M, LinkMask Mask, Scalar T>
[[nodiscard]] CentreOfMass<M::joints, T> centre_of_mass(const M& model,
                                                        const Poses<M, Mask, T>& poses) noexcept {
  static_assert(Mask == all_links(M::joints), "the centre of mass needs the poses of all links");
  constexpr std::size_t N = M::joints;
  CentreOfMass<N, T> out;
  T mass[N];
  Xyz<T> h[N];  // first moments of subtrees about the base's origin
  detail::unrolled<N>([&](auto i) SKINCTL_INLINE_LAMBDA {
    using P = LinkParameter;
    const auto X = poses.template get<i>();
    const Xyz<T> c =
        dense<T>(Triple{model.template number<i, P::c_x, T>(), model.template number<i, P::c_y, T>(),
                        model.template number<i, P::c_z, T>()});
    mass[i] = T(model.template number<i, P::mass, T>());
    h[i] = mass[i] * (X.origin() + X.axes() * c);
  });
  Xyz<T> all{T(0), T(0), T(0)};
  for (std::size_t k = N; k-- > 0;) {
    if (M::parents[k] >= 0) {
      const auto parent = static_cast<std::size_t>(M::parents[k]);
      mass[parent] = mass[parent] + mass[k];
      h[parent] = h[parent] + h[k];
    } else {
      out.mass = out.mass + mass[k];
      all = all + h[k];
    }
  }
  const auto any = out.mass > T(0);
  const T per_mass = select(any, T(T(1) / select(any, out.mass, T(1))), T(0));
  out.p = per_mass * all;
  detail::unrolled<N>([&](auto i) SKINCTL_INLINE_LAMBDA {
    const auto X = poses.template get<i>();
    if constexpr (M::kinds[i] == JointKind::revolute) {
      out.columns[i] = per_mass * cross(X.axis_z(), h[i] - mass[i] * X.origin());
    } else {
      out.columns[i] = (per_mass * mass[i]) * X.axis_z();
    }
  });
  return out;
}
template <RobotModel M, Scalar T>
[[nodiscard]] CentreOfMass<M::joints, T> centre_of_mass(const M& model,
                                                        const JointPosition<M::joints, T>& q) noexcept {
  return centre_of_mass(model, link_poses(model, q));
}

SKINCTL_END_NAMESPACE
