// SPDX-License-Identifier: BSD-3-Clause
// Velocity of a rigid body. The type names the body, the reference frame, the point and the axes.
#pragma once

#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Velocity of the body to which frame `Body` is fixed, as seen from frame `Relative`: the velocity of the
/// body's point that is at the origin of `At` now, and the angular velocity, both along the axes of `Axes`.
/// Zero by default. `Twist<B, A, B, E>` has the monogram `V_AB_E`: B relative to A, at B's own origin.
template <Frame Body, Frame Relative, Frame At = Body, Frame Axes = Relative, Scalar T = double>
struct Twist {
  Xyz<T> linear{T(0), T(0), T(0)};   ///< velocity of the body's point at the origin of `At` [m/s]
  Xyz<T> angular{T(0), T(0), T(0)};  ///< angular velocity [rad/s]

  /// A twist from an Eigen vector of six numbers, linear part first.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Twist from_eigen(const V& v) noexcept {
    return detail::from_six<Twist, T>(v);
  }
  /// The six numbers as an Eigen vector, linear part first.
  [[nodiscard]] friend Vec6<T> as_eigen(const Twist& V) noexcept { return detail::six(V.linear, V.angular); }
  /// The velocity of `Relative` as seen from `Body`: `V_BA` of `V_AB`.
  [[nodiscard]] SKINCTL_INLINE constexpr Twist<Relative, Body, At, Axes, T> reversed() const noexcept {
    return {-linear, -angular};
  }
  template <Scalar U>
  [[nodiscard]] SKINCTL_INLINE constexpr Twist<Body, Relative, At, Axes, U> cast() const noexcept {
    return {skinctl::cast<U>(linear), skinctl::cast<U>(angular)};
  }

  SKINCTL_INLINE constexpr Twist operator+(const Twist& W) const noexcept {
    return {linear + W.linear, angular + W.angular};
  }
  /// `V_AC = V_AB + V_BC`, of the same point along the same axes: velocities add up along a chain of bodies.
  template <Frame C>
    requires(!std::same_as<Twist<C, Body, At, Axes, T>, Twist>)
  SKINCTL_INLINE constexpr Twist<C, Relative, At, Axes, T> operator+(
      const Twist<C, Body, At, Axes, T>& V_BC) const noexcept {
    return {linear + V_BC.linear, angular + V_BC.angular};
  }
  SKINCTL_INLINE constexpr Twist operator-(const Twist& W) const noexcept {
    return {linear - W.linear, angular - W.angular};
  }
  SKINCTL_INLINE constexpr Twist operator-() const noexcept { return {-linear, -angular}; }
  friend SKINCTL_INLINE constexpr Twist operator*(const T& s, const Twist& V) noexcept {
    return {s * V.linear, s * V.angular};
  }
  /// The same velocity of the same point, along the axes of `F`.
  template <Frame F>
  friend SKINCTL_INLINE constexpr Twist<Body, Relative, At, F, T> express(const Transform<F, Axes, T>& X_FE,
                                                                          const Twist& V) noexcept {
    return {X_FE.axes() * V.linear, X_FE.axes() * V.angular};
  }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Twist<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // no chain V_AB + V_BC of one point along the same axes
  template <class Q> void operator-(const Q&) const = delete;  // other body, point or axes: express, reversed, X_QP * V
  friend void express(const AnyTransform auto&, const Twist&) = delete;  // X_FE takes a twist along E's axes
  // clang-format on
};

template <class V>
inline constexpr bool is_twist = false;
template <class B, class A, class P, class E, class T>
inline constexpr bool is_twist<Twist<B, A, P, E, T>> = true;
template <class V>
concept AnyTwist = is_twist<V>;

/// Changes point and axes: from the origin and axes of P to those of Q. `X_QP` rotates the axes and moves the
/// point.
template <class B, class A, class P, class Q, class T>
[[nodiscard]] SKINCTL_INLINE constexpr Twist<B, A, Q, Q, T> transformed(
    const Transform<Q, P, T>& X_QP, const Twist<B, A, P, P, T>& V) noexcept {
  const Xyz<T> angular = X_QP.axes() * V.angular;
  return {X_QP.axes() * V.linear + cross(X_QP.origin(), angular), angular};
}

SKINCTL_END_NAMESPACE
