// SPDX-License-Identifier: BSD-3-Clause
// The mass matrix of a robot.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/detail/composite.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A symmetric N x N matrix that maps joint accelerations to joint torques, both triangles stored, row by
/// row. `M * ddq` is a torque; products with other kinds do not compile.
template <std::size_t N, Scalar T = double>
struct MassMatrix {
  T data[N * N];

  constexpr MassMatrix() noexcept : data{} {}
  /// Leaves the entries uninitialised, for a matrix that is overwritten completely: GCC would keep the zeros.
  struct Unset {};
  SKINCTL_INLINE constexpr explicit MassMatrix(Unset) noexcept {}
  /// A mass matrix from an Eigen matrix, N x N of scalar `T`, which is symmetric to within `tolerance<T>` of
  /// its largest element.
  template <VectorExpression E>
  explicit MassMatrix(const E& values) noexcept : data{} {
    static_assert(std::is_same_v<typename E::Scalar, T>, "other scalar: M.cast<T>()");
    const EigenMatrix<T, int(N), int(N)> m = values;
    if constexpr (Real<T>)
      SKINCTL_EXPECTS((m - m.transpose()).cwiseAbs().maxCoeff() <= tolerance<T> * m.cwiseAbs().maxCoeff(),
                      "a mass matrix is symmetric");
    for (std::size_t i = 0; i < N * N; ++i) data[i] = m.coeff(static_cast<std::ptrdiff_t>(i));
  }

  SKINCTL_INLINE constexpr T& operator()(std::size_t i, std::size_t j) noexcept { return data[i * N + j]; }
  SKINCTL_INLINE constexpr const T& operator()(std::size_t i, std::size_t j) const noexcept {
    return data[i * N + j];
  }

  /// The torque `M ddq` [N m].
  SKINCTL_INLINE constexpr JointTorque<N, T> operator*(const JointAcceleration<N, T>& ddq) const noexcept {
    JointTorque<N, T> tau;
    const auto row = [&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      T sum(0);
      if constexpr (N <= 8) {
        detail::unrolled<N>([&](std::size_t j)
                                SKINCTL_INLINE_LAMBDA { sum = sum + data[i * N + j] * ddq[j]; });
      } else {
        for (std::size_t j = 0; j < N; ++j) sum = sum + data[i * N + j] * ddq[j];
      }
      tau[i] = sum;
    };
    if constexpr (N <= 8) {
      detail::unrolled<N>(row);
    } else {
      for (std::size_t i = 0; i < N; ++i) row(i);
    }
    return tau;
  }
  /// The mass matrix as an Eigen matrix, without a copy; read-only, because both triangles are stored.
  [[nodiscard]] friend SKINCTL_INLINE EigenMap<const EigenMatrix<T, int(N), int(N)>> as_eigen(
      const MassMatrix& M) noexcept {
    return EigenMap<const EigenMatrix<T, int(N), int(N)>>(M.data);
  }
  // clang-format off
  friend void as_eigen(const MassMatrix&&) = delete;  // a view of a temporary: give it a name first
  template <class Q> void operator*(const Q&) const = delete;  // M takes joint accelerations: M * ddq
  template <EigenExpression E>
  MassMatrix(const E&) = delete;  // from Eigen: MassMatrix<N>(m)
  template <EigenExpression E>
  void operator=(const E&) = delete;  // from Eigen: M = MassMatrix<N>(m)
  template <EigenExpression E>
  operator E() const = delete;  // to Eigen: as_eigen(M)
  // clang-format on
};

namespace detail {

/// Transforms the wrench of a unit acceleration of `joint`, given in the axes and about the origin of link
/// `Ix`, down to the base, and writes its torque about each joint on the path.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles, class F, class N>
SKINCTL_INLINE constexpr void carry_wrench(const M& model, const Angles& angles, const F& f, const N& n,
                                           std::size_t joint, MassMatrix<M::joints, T>& m) noexcept {
  constexpr int parent = M::parents[Ix];
  if constexpr (parent >= 0) {
    constexpr auto P = static_cast<std::size_t>(parent);
    const auto frame = joint_frame<Ix>(model, angles);
    const auto f_parent = frame.to_parent(f);
    const auto n_parent = frame.to_parent(n) + cross(frame.p, f_parent);
    constexpr bool revolute = M::kinds[P] == JointKind::revolute;
    m(P, joint) = m(joint, P) = revolute ? T(n_parent.z) : T(f_parent.z);
    carry_wrench<P>(model, angles, f_parent, n_parent, joint, m);
  }
}

/// Writes the rows and columns of `M` that the wrench of a unit acceleration of joint `Ix` alone fills;
/// `body` is the subtree of link `Ix` as one body in the frame of the link.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles, class Body>
SKINCTL_INLINE constexpr void write_mass(const M& model, const Angles& angles, const Body& body,
                                         MassMatrix<M::joints, T>& m) noexcept {
  if constexpr (M::kinds[Ix] == JointKind::revolute) {
    const auto inertia = body.xx + body.yy;
    m(Ix, Ix) = T(inertia);
    carry_wrench<Ix>(model, angles, Triple{-body.h.y, body.h.x, TypedConstant<0>{}},
                     Triple{-body.xz, -body.yz, inertia}, Ix, m);
  } else {
    m(Ix, Ix) = T(body.mass);
    carry_wrench<Ix>(model, angles, Triple{TypedConstant<0>{}, TypedConstant<0>{}, body.mass},
                     Triple{body.h.y, -body.h.x, TypedConstant<0>{}}, Ix, m);
  }
}

/// Computes the rows and columns of `M` for the subtree of link `Ix`, and returns the subtree as one body in
/// the frame of the link.
template <std::size_t Ix, Scalar T, RobotModel M, class Angles>
SKINCTL_INLINE constexpr auto subtree_mass(const M& model, const Angles& angles,
                                           MassMatrix<M::joints, T>& m) noexcept {
  constexpr auto carried = children<M, int(Ix)>;
  const auto own = link_composite<Ix, T>(model);
  if constexpr (carried.size() == 0) {
    write_mass<Ix>(model, angles, own, m);
    return own;
  } else if constexpr (carried.size() == 1) {
    const auto body =
        carrying(own, joint_frame<carried[0]>(model, angles), subtree_mass<carried[0], T>(model, angles, m));
    write_mass<Ix>(model, angles, body, m);
    return body;
  } else {
    auto body = dense_composite<T>(own);
    for_each_link<carried>([&](auto child) SKINCTL_INLINE_LAMBDA {
      body = dense_composite<T>(carrying(body, joint_frame<child.value>(model, angles),
                                         subtree_mass<child.value, T>(model, angles, m)));
    });
    write_mass<Ix>(model, angles, body, m);
    return body;
  }
}

/// A matrix to write to: uninitialised for a chain, whose entries are all written; zeros for other trees.
template <Scalar T, RobotModel M>
SKINCTL_INLINE MassMatrix<M::joints, T> empty_mass() noexcept {
  using Matrix = MassMatrix<M::joints, T>;
  constexpr bool chain = [] {
    bool one = true;
    for (std::size_t i = 0; i < M::joints; ++i) one = one && M::parents[i] == int(i) - 1;
    return one;
  }();
  if constexpr (chain) {
    return Matrix(typename Matrix::Unset{});
  } else {
    return Matrix();
  }
}

}  // namespace detail

/// `M(q)` [kg m^2], symmetric positive definite for links with mass: the composite-rigid-body recursion in
/// link frames, where an entry is simply the z component of a moment. Joints in different branches are not
/// coupled: those entries are exact zeros. Relative to the largest entry, the error is a few units in the
/// last place times the depth of the tree; of a UR5 within 6.2e-15 kg m^2 (float: 3.5e-6) at every state
/// (proven, `bench/studies/bounds`).
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE MassMatrix<M::joints, T> mass_matrix(
    const M& model, const JointAngles<M, T, Mask>& angles) noexcept {
  MassMatrix<M::joints, T> m = detail::empty_mass<T, M>();
  constexpr auto roots = children<M, -1>;
  if constexpr (roots.size() == 1) {
    static_cast<void>(detail::subtree_mass<roots[0], T>(model, angles, m));
  } else {
    detail::for_each_link<roots>([&](auto child) SKINCTL_INLINE_LAMBDA {
      static_cast<void>(detail::subtree_mass<child.value, T>(model, angles, m));
    });
  }
  return m;
}
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE MassMatrix<M::joints, T> mass_matrix(
    const M& model, const JointPosition<M::joints, T>& q) noexcept {
  return mass_matrix(model, JointAngles<M, T>(model, q));
}
// clang-format off
template <RobotModel M, Scalar T> requires(!computes_in<M, T>)
void mass_matrix(const M&, const JointPosition<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
template <RobotModel M, class... Q> requires(any_eigen<Q...>)
void mass_matrix(const M&, const Q&...) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
// clang-format on

SKINCTL_END_NAMESPACE
