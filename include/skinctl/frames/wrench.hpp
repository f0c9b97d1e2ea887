// SPDX-License-Identifier: BSD-3-Clause
// Force and moment on a rigid body. The type names the body, the point and the axes.
#pragma once

#include "skinctl/frames/twist.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Load on the body to which frame `Body` is fixed: a force, and a moment about the origin of `At`, both
/// along the axes of `Axes`; written `F_Body_At_Axes`. Zero by default.
///
/// A force through the origin of `At` has no moment there; `X_QP * F` gives its moment about another point.
template <Frame Body, Frame At = Body, Frame Axes = At, Scalar T = double>
struct Wrench {
  Xyz<T> force{T(0), T(0), T(0)};   ///< force on the body [N]
  Xyz<T> moment{T(0), T(0), T(0)};  ///< moment about the origin of `At` [N m]

  /// A wrench from an Eigen vector of six numbers, force first.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Wrench from_eigen(const V& v) noexcept {
    return detail::from_six<Wrench, T>(v);
  }
  /// The six numbers as an Eigen vector, force first.
  [[nodiscard]] friend Vec6<T> as_eigen(const Wrench& F) noexcept { return detail::six(F.force, F.moment); }
  template <Scalar U>
  [[nodiscard]] SKINCTL_INLINE constexpr Wrench<Body, At, Axes, U> cast() const noexcept {
    return {skinctl::cast<U>(force), skinctl::cast<U>(moment)};
  }
  /// The same wrench on `Other`, which is rigidly fixed to `Body` (a tool on its flange). This is not
  /// checked.
  template <Frame Other>
  [[nodiscard]] SKINCTL_INLINE constexpr Wrench<Other, At, Axes, T> on() const noexcept {
    return {force, moment};
  }

  SKINCTL_INLINE constexpr Wrench operator+(const Wrench& G) const noexcept {
    return {force + G.force, moment + G.moment};
  }
  SKINCTL_INLINE constexpr Wrench operator-(const Wrench& G) const noexcept {
    return {force - G.force, moment - G.moment};
  }
  SKINCTL_INLINE constexpr Wrench operator-() const noexcept { return {-force, -moment}; }
  friend SKINCTL_INLINE constexpr Wrench operator*(const T& s, const Wrench& F) noexcept {
    return {s * F.force, s * F.moment};
  }
  /// The same load about the same point, along the axes of `G`.
  template <Frame G>
  friend SKINCTL_INLINE constexpr Wrench<Body, At, G, T> express(const Transform<G, Axes, T>& X_GE,
                                                                 const Wrench& F) noexcept {
    return {X_GE.axes() * F.force, X_GE.axes() * F.moment};
  }
  /// Power of the load on the moving body [W]: `f . v + m . omega`. It does not depend on the common point
  /// and axes of load and velocity.
  template <Frame A>
  friend SKINCTL_INLINE constexpr T power(const Wrench& F, const Twist<Body, A, At, Axes, T>& V) noexcept {
    return F.force.x * V.linear.x + F.force.y * V.linear.y + F.force.z * V.linear.z +
           F.moment.x * V.angular.x + F.moment.y * V.angular.y + F.moment.z * V.angular.z;
  }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Wrench<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // other body, point or axes: express, X_LC * F
  template <class Q> void operator-(const Q&) const = delete;  // other body, point or axes: express, X_LC * F
  friend void express(const AnyTransform auto&, const Wrench&) = delete;  // X_GE takes a wrench along E's axes
  friend void power(const Wrench&, const AnyTwist auto&) = delete;  // wrench and twist differ in body, point or axes
  // clang-format on
};

/// Changes point and axes: from the origin and axes of P to those of Q. `X_LC * F` is a cell's load on its
/// link.
template <class B, class P, class Q, class T>
[[nodiscard]] SKINCTL_INLINE constexpr Wrench<B, Q, Q, T> transformed(const Transform<Q, P, T>& X_QP,
                                                                      const Wrench<B, P, P, T>& F) noexcept {
  const Xyz<T> force = X_QP.axes() * F.force;
  return {force, X_QP.axes() * F.moment + cross(X_QP.origin(), force)};
}
SKINCTL_END_NAMESPACE
