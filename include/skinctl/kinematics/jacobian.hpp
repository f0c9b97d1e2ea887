// SPDX-License-Identifier: BSD-3-Clause
// Jacobians: from joint velocities to the velocity of a body, from a wrench on it to joint torques.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/frames/acceleration.hpp"
#include "skinctl/frames/twist.hpp"
#include "skinctl/frames/wrench.hpp"
#include "skinctl/kinematics/poses.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class J>
class Transposed;

/// The geometric Jacobian of frame `Body` (a link, or a frame fixed to one) relative to `Base`: column i is
/// the velocity of the origin of `At`, and the angular velocity, along the axes of `Axes`, when joint i moves
/// at 1 rad/s (1 m/s).
///
/// `Columns` are the joints on the way from the base to the body, known from the topology. The other columns
/// are zero; they are neither stored nor multiplied. Every number of that of a UR5's tool is within 2.2e-15
/// (float: 1.2e-6) of the exact one at every state (proven, `bench/studies/bounds`).
template <Topology M, LinkMask Columns, Frame Body, Frame At = Body, Frame Axes = Base, Scalar T = double>
class Jacobian {
 public:
  static constexpr std::size_t joints = M::joints;
  static constexpr LinkMask columns = Columns;
  using scalar = T;
  using Load = Wrench<Body, At, Axes, T>;  ///< the argument of `transpose(J)`

  struct Column {
    Xyz<T> linear;   ///< velocity of the origin of `At` per velocity of the joint [m/rad] or [1]
    Xyz<T> angular;  ///< angular velocity per velocity of the joint [1], or 0
  };

  /// Column of joint `Ix`; one that is zero by topology does not compile.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE const Column& column() const noexcept {
    static_assert((Columns >> Ix) & 1u, "this joint does not move the body: its column is zero");
    return columns_[slot(Ix)];
  }
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE Column& column() noexcept {
    static_assert((Columns >> Ix) & 1u, "this joint does not move the body: its column is zero");
    return columns_[slot(Ix)];
  }

  /// `V = J dq`: the velocity of the body.
  [[nodiscard]] SKINCTL_INLINE Twist<Body, Base, At, Axes, T> operator*(
      const JointVelocity<joints, T>& dq) const noexcept {
    Twist<Body, Base, At, Axes, T> V;
    for_each([&](auto i, const Column& column) SKINCTL_INLINE_LAMBDA {
      V.linear = V.linear + dq[i.value] * column.linear;
      V.angular = V.angular + dq[i.value] * column.angular;
    });
    return V;
  }
  /// `J ddq`: the body's acceleration due to the joint accelerations. The acceleration of the body is
  /// `J ddq + dJ dq` (`jacobian_rate`, or `bias_acceleration`).
  [[nodiscard]] SKINCTL_INLINE Acceleration<Body, Base, At, Axes, T> operator*(
      const JointAcceleration<joints, T>& ddq) const noexcept {
    Acceleration<Body, Base, At, Axes, T> a;
    for_each([&](auto i, const Column& column) SKINCTL_INLINE_LAMBDA {
      a.linear = a.linear + ddq[i.value] * column.linear;
      a.angular = a.angular + ddq[i.value] * column.angular;
    });
    return a;
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // a Jacobian takes joint velocities or accelerations, its transpose a wrench: J * dq, J * ddq, transpose(J) * F
  template <EigenExpression E>
  void operator=(const E&) = delete;  // from Eigen: a Jacobian of the same type's from_eigen(m)
  template <EigenExpression E>
  operator E() const = delete;  // to Eigen: as_eigen(J)
  // clang-format on

  /// A Jacobian from an Eigen matrix, 6 x N, linear rows first; columns zero by topology are not read.
  template <VectorExpression E>
  [[nodiscard]] static Jacobian from_eigen(const E& values) noexcept {
    static_assert(std::is_same_v<typename E::Scalar, T>, "other scalar: J.cast<T>()");
    const EigenMatrix<T, 6, int(joints)> m = values;
    Jacobian J;
    for (std::size_t i = 0; i < joints; ++i) {
      if (!((Columns >> i) & 1u)) continue;
      const Vec6<T> c = m.col(static_cast<std::ptrdiff_t>(i));
      J.columns_[slot(i)] = {detail::three(c, 0), detail::three(c, 3)};
    }
    return J;
  }

  /// The full matrix, 6 x N, linear rows first, zero columns included.
  [[nodiscard]] friend EigenMatrix<T, 6, int(joints)> as_eigen(const Jacobian& J) noexcept {
    EigenMatrix<T, 6, int(joints)> m = EigenMatrix<T, 6, int(joints)>::Zero();
    J.for_each([&](auto i, const Column& c) {
      m.col(static_cast<std::ptrdiff_t>(i.value)) = detail::six(c.linear, c.angular);
    });
    return m;
  }

  /// Calls `f(Ix, column)` for the joints that move the body, `Ix` an integral constant.
  template <class F>
  SKINCTL_INLINE void for_each(F&& f) const noexcept {
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
      const auto one = [&](auto i) SKINCTL_INLINE_LAMBDA {
        if constexpr ((Columns >> i.value) & 1u) f(i, columns_[slot(i.value)]);
      };
      (one(std::integral_constant<std::size_t, Ix>{}), ...);
    }(std::make_index_sequence<joints>{});
  }

 private:
  static constexpr std::size_t slot(std::size_t i) noexcept {
    return static_cast<std::size_t>(std::popcount(Columns & ((LinkMask(1) << i) - 1)));
  }
  Column columns_[static_cast<std::size_t>(std::popcount(Columns))];
};

/// The transpose of a Jacobian: `tau = transpose(J) * F`, eq. (6), the joint torques of a wrench on the body.
template <class J>
class Transposed {
 public:
  SKINCTL_INLINE explicit Transposed(const J& jacobian) noexcept : jacobian_(jacobian) {}

  [[nodiscard]] SKINCTL_INLINE JointTorque<J::joints, typename J::scalar> operator*(
      const typename J::Load& F) const noexcept {
    JointTorque<J::joints, typename J::scalar> tau;
    jacobian_.for_each([&](auto i, const auto& column) SKINCTL_INLINE_LAMBDA {
      tau[i.value] = dot(column.linear, F.force) + dot(column.angular, F.moment);
    });
    return tau;
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // body, point and axes of J and F differ, or it is no wrench
  // clang-format on

 private:
  const J& jacobian_;
};

template <class M, LinkMask C, class B, class P, class E, class T>
[[nodiscard]] SKINCTL_INLINE Transposed<Jacobian<M, C, B, P, E, T>> transpose(
    const Jacobian<M, C, B, P, E, T>& J) noexcept {
  return Transposed<Jacobian<M, C, B, P, E, T>>(J);
}

/// Jacobian of the frame `P` that is fixed to link `Ix` at `X_LP`: of P's origin, along the axes of the base.
/// `poses` must hold every link from the base to link `Ix`.
template <std::size_t Ix, Frame P, class M, LinkMask Mask, class T>
[[nodiscard]] SKINCTL_INLINE Jacobian<M, ancestors<M>(Ix), P, P, Base, T> jacobian(
    const Poses<M, Mask, T>& poses, const Transform<Link<Ix>, P, T>& X_LP) noexcept {
  static_assert((ancestors<M>(Ix) & ~Mask) == 0,
                "a Jacobian needs the poses of all links on the way to its link");
  const auto body = poses.template place<Ix>();
  const Xyz<T>& at = X_LP.origin();
  const Xyz<T> p = dense<T>(body.p + at.x * body.x + at.y * body.y + at.z * body.z);
  Jacobian<M, ancestors<M>(Ix), P, P, Base, T> J;
  [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
    const auto one = [&](auto k) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t joint = k.value;
      if constexpr ((ancestors<M>(Ix) >> joint) & 1u) {
        const auto link = poses.template place<joint>();
        auto& column = J.template column<joint>();
        if constexpr (M::kinds[joint] == JointKind::revolute) {
          assign(column.linear, cross(link.z, p - link.p));
          assign(column.angular, link.z);
        } else {
          assign(column.linear, link.z);
          assign(column.angular, ZeroTriple{});
        }
      }
    };
    (one(std::integral_constant<std::size_t, K>{}), ...);
  }(std::make_index_sequence<M::joints>{});
  return J;
}

/// Jacobian of link `Ix`: of its frame's origin, along the axes of the base.
template <std::size_t Ix, class M, LinkMask Mask, class T>
[[nodiscard]] SKINCTL_INLINE Jacobian<M, ancestors<M>(Ix), Link<Ix>, Link<Ix>, Base, T> jacobian(
    const Poses<M, Mask, T>& poses) noexcept {
  return jacobian<Ix>(poses, Transform<Link<Ix>, Link<Ix>, T>());
}

SKINCTL_END_NAMESPACE
