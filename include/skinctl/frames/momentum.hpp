// Momentum of a rigid body. The type names the body, the reference frame, the point and the axes.
#pragma once

#include "skinctl/frames/twist.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Momentum of a body as seen from `Relative`: linear, and angular about the origin of `At`, along the axes
/// of `Axes`. In an inertial frame its rate of change is the sum of the wrenches on the body.
template <Frame Body, Frame Relative, Frame At = Body, Frame Axes = At, Scalar T = double>
struct Momentum {
  Xyz<T> linear{T(0), T(0), T(0)};   ///< [kg m/s]
  Xyz<T> angular{T(0), T(0), T(0)};  ///< [kg m^2/s]

  /// From an Eigen vector of six numbers, linear part first.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Momentum from_eigen(const V& v) noexcept {
    return detail::from_six<Momentum, T>(v);
  }
  /// The six numbers as an Eigen vector, linear part first.
  [[nodiscard]] friend Vec6<T> as_eigen(const Momentum& h) noexcept {
    return detail::six(h.linear, h.angular);
  }
  SKINCTL_INLINE constexpr Momentum operator+(const Momentum& k) const noexcept {
    return {linear + k.linear, angular + k.angular};
  }
  SKINCTL_INLINE constexpr Momentum operator-(const Momentum& k) const noexcept {
    return {linear - k.linear, angular - k.angular};
  }
  SKINCTL_INLINE constexpr Momentum operator-() const noexcept { return {-linear, -angular}; }
  friend SKINCTL_INLINE constexpr Momentum operator*(const T& s, const Momentum& h) noexcept {
    return {s * h.linear, s * h.angular};
  }
  /// About another point: `l_Q = l_P - p_PQ x p`, like the moment of a wrench.
  template <Frame Q>
  friend SKINCTL_INLINE constexpr Momentum<Body, Relative, Q, Axes, T> shift(
      const Momentum& h, const Offset<At, Q, Axes, T>& p_PQ_E) noexcept {
    return {h.linear, h.angular + cross(h.linear, p_PQ_E.xyz)};
  }
  /// The same momentum about the same point, along the axes of `G`.
  template <Frame G>
  friend SKINCTL_INLINE constexpr Momentum<Body, Relative, At, G, T> express(
      const Transform<G, Axes, T>& X_GE, const Momentum& h) noexcept {
    return {X_GE.axes() * h.linear, X_GE.axes() * h.angular};
  }
  /// `v . p + omega . l` [J]: twice the kinetic energy where `V` is the body's own velocity.
  friend SKINCTL_INLINE constexpr T dot(const Twist<Body, Relative, At, Axes, T>& V,
                                        const Momentum& h) noexcept {
    return dot(V.linear, h.linear) + dot(V.angular, h.angular);
  }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Momentum<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // other body, point or axes: shift, express
  template <class Q> void operator-(const Q&) const = delete;  // other body, point or axes: shift, express
  friend void shift(const Momentum&, const AnyOffset auto&) = delete;  // a momentum at P along E needs p_PQ_E
  friend void express(const AnyTransform auto&, const Momentum&) = delete;  // X_GE takes a momentum along E's axes
  friend void dot(const AnyTwist auto&, const Momentum&) = delete;  // they differ in body, point or axes
  // clang-format on
};

/// Changes point and axes: from the origin and axes of P to those of Q.
template <class B, class A, class P, class Q, class T>
[[nodiscard]] SKINCTL_INLINE constexpr Momentum<B, A, Q, Q, T> transformed(
    const Transform<Q, P, T>& X_QP, const Momentum<B, A, P, P, T>& h) noexcept {
  const Xyz<T> linear = X_QP.axes() * h.linear;
  return {linear, X_QP.axes() * h.angular + cross(X_QP.origin(), linear)};
}
SKINCTL_END_NAMESPACE
