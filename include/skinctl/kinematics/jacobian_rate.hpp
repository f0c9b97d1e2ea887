// SPDX-License-Identifier: BSD-3-Clause
// The time derivative of a Jacobian, and accelerations from it.
#pragma once

#include "skinctl/frames/acceleration.hpp"
#include "skinctl/kinematics/jacobian.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class J>
class JacobianRate;

/// `dJ/dt` of the geometric Jacobian of a frame's own origin along the axes of the base, while the joints
/// move at `dq`. It has the zero columns of J, which are neither stored nor multiplied.
///
/// It follows from J alone: the joints up to joint i carry column i along, the joints after it move the
/// point:
///
///     d linear_i  = w_i x linear_i + angular_i x sum_{k > i} linear_k dq_k
///     d angular_i = w_i x angular_i
///
/// with `w_i` the angular velocity of link i and k along the path from i to the body. Relative error a few
/// units in the last place of |dq| times the reach.
template <Topology M, LinkMask Columns, Frame Body, Scalar T>
class JacobianRate<Jacobian<M, Columns, Body, Body, Base, T>> {
 public:
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
  using Column = typename Of::Column;  ///< column of dJ/dt [m/s^2], [rad/s^2] per joint unit per second
  using scalar = T;
  static constexpr std::size_t joints = M::joints;
  static constexpr LinkMask columns = Columns;

  SKINCTL_INLINE JacobianRate(const Of& J, const JointVelocity<joints, T>& dq) noexcept {
    Xyz<T> outside = (J * dq).linear;
    Xyz<T> w{T(0), T(0), T(0)};
    J.for_each([&](auto i, const Column& c) SKINCTL_INLINE_LAMBDA {
      outside = outside - dq[i.value] * c.linear;
      if constexpr (M::kinds[i.value] == JointKind::revolute) {
        const Xyz<T> turned = cross(w, c.angular);
        w = w + dq[i.value] * c.angular;
        dJ_.template column<i.value>() = {cross(w, c.linear) + cross(c.angular, outside), turned};
      } else {
        dJ_.template column<i.value>() = {cross(w, c.linear), {T(0), T(0), T(0)}};
      }
    });
  }

  /// Column of joint `Ix`; one that is zero by topology does not compile.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE const Column& column() const noexcept {
    return dJ_.template column<Ix>();
  }
  /// Calls `f(Ix, column)` for the joints that move the body, `Ix` an integral constant.
  template <class F>
  SKINCTL_INLINE void for_each(F&& f) const noexcept {
    dJ_.for_each(f);
  }
  /// `dJ v`: part of the acceleration that belongs to the joint velocities `v`. For `v = dq` alone
  /// `bias_acceleration` is cheaper.
  [[nodiscard]] SKINCTL_INLINE Acceleration<Body, Base, Body, Base, T> operator*(
      const JointVelocity<joints, T>& v) const noexcept {
    const auto a = dJ_ * v;
    return {a.linear, a.angular};
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // the rate of a Jacobian takes joint velocities: dJ * dq
  // clang-format on

  /// The full matrix, 6 x N, linear rows first, zero columns included.
  [[nodiscard]] friend EigenMatrix<T, 6, int(joints)> as_eigen(const JacobianRate& dJ) noexcept {
    return as_eigen(dJ.dJ_);
  }

 private:
  Of dJ_;
};

/// The time derivative `dJ/dt` of a Jacobian while the joints move at `dq`.
template <Topology M, LinkMask C, Frame Body, Scalar T>
[[nodiscard]] SKINCTL_INLINE auto jacobian_rate(const Jacobian<M, C, Body, Body, Base, T>& J,
                                                const JointVelocity<M::joints, T>& dq) noexcept {
  return JacobianRate<Jacobian<M, C, Body, Body, Base, T>>(J, dq);
}

/// `dJ v` of joints that move at `dq`, without forming dJ: `sum of w_i x v_i linear_i + v_i angular_i x
/// outside_i` and of `w_p x v_i angular_i`, where p is the joint before i.
/// @param V  velocity of the body, `J dq`.
template <Topology M, LinkMask C, Frame Body, Scalar T>
[[nodiscard]] SKINCTL_INLINE Acceleration<Body, Base, Body, Base, T> jacobian_rate_times(
    const Jacobian<M, C, Body, Body, Base, T>& J, const JointVelocity<M::joints, T>& dq,
    const JointVelocity<M::joints, T>& v, const Twist<Body, Base, Body, Base, T>& V) noexcept {
  Acceleration<Body, Base, Body, Base, T> a;
  Xyz<T> outside = V.linear;
  Xyz<T> w{T(0), T(0), T(0)};
  J.for_each([&](auto i, const auto& c) SKINCTL_INLINE_LAMBDA {
    outside = outside - dq[i.value] * c.linear;
    const Xyz<T> moved = v[i.value] * c.linear;
    if constexpr (M::kinds[i.value] == JointKind::revolute) {
      const Xyz<T> turn = v[i.value] * c.angular;
      a.angular = a.angular + cross(w, turn);
      w = w + dq[i.value] * c.angular;
      a.linear = a.linear + cross(w, moved) + cross(turn, outside);
    } else {
      a.linear = a.linear + cross(w, moved);
    }
  });
  return a;
}

/// `J ddq + dJ dq`: the acceleration of the body, without forming dJ: joint k adds
/// `(w_k + w_p) x linear_k dq_k` and `w_p x angular_k dq_k`, where p is the joint before it.
template <Topology M, LinkMask C, Frame Body, Scalar T>
[[nodiscard]] SKINCTL_INLINE Acceleration<Body, Base, Body, Base, T> acceleration(
    const Jacobian<M, C, Body, Body, Base, T>& J, const JointVelocity<M::joints, T>& dq,
    const JointAcceleration<M::joints, T>& ddq) noexcept {
  Acceleration<Body, Base, Body, Base, T> a;
  Xyz<T> w{T(0), T(0), T(0)};
  J.for_each([&](auto i, const auto& c) SKINCTL_INLINE_LAMBDA {
    const Xyz<T> v = dq[i.value] * c.linear;
    if constexpr (M::kinds[i.value] == JointKind::revolute) {
      const Xyz<T> turn = dq[i.value] * c.angular;
      a.angular = a.angular + ddq[i.value] * c.angular + cross(w, turn);
      a.linear = a.linear + ddq[i.value] * c.linear + cross(w + w + turn, v);
      w = w + turn;
    } else {
      a.linear = a.linear + ddq[i.value] * c.linear + cross(w + w, v);
    }
  });
  return a;
}

/// `dJ dq`: the acceleration of the body while the joints move at constant speed.
template <Topology M, LinkMask C, Frame Body, Scalar T>
[[nodiscard]] SKINCTL_INLINE Acceleration<Body, Base, Body, Base, T> bias_acceleration(
    const Jacobian<M, C, Body, Body, Base, T>& J, const JointVelocity<M::joints, T>& dq) noexcept {
  return acceleration(J, dq, JointAcceleration<M::joints, T>());
}

SKINCTL_END_NAMESPACE
