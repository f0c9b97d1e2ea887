// Acceleration of a rigid body: of what, relative to what, of which point, along which axes.
#pragma once

#include "skinctl/frames/twist.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rate of change of a `Twist` of the same names: the acceleration of that point of the body which is at the
/// origin of `At` now, as it moves with the body (the one an accelerometer there feels, but for gravity; not
/// the "spatial" one of screw theory), and the angular acceleration. Zero by default.
template <Frame Body, Frame Relative, Frame At = Body, Frame Axes = Relative, Scalar T = double>
struct Acceleration {
  Xyz<T> linear{T(0), T(0), T(0)};   ///< [m/s^2]
  Xyz<T> angular{T(0), T(0), T(0)};  ///< [rad/s^2]

  SKINCTL_INLINE constexpr Acceleration operator+(const Acceleration& A) const noexcept {
    return {linear + A.linear, angular + A.angular};
  }
  SKINCTL_INLINE constexpr Acceleration operator-(const Acceleration& A) const noexcept {
    return {linear - A.linear, angular - A.angular};
  }
  SKINCTL_INLINE constexpr Acceleration operator-() const noexcept { return {-linear, -angular}; }
  friend SKINCTL_INLINE constexpr Acceleration operator*(const T& s, const Acceleration& A) noexcept {
    return {s * A.linear, s * A.angular};
  }

  // clang-format off
  template <class Q> void operator+(const Q&) const = delete;  // other body, point or axes, or no acceleration
  template <class Q> void operator-(const Q&) const = delete;  // other body, point or axes, or no acceleration
  // clang-format on
};

/// The six numbers as an Eigen vector, linear part first.
template <class B, class A, class P, class E, class T>
[[nodiscard]] Vec6<T> as_eigen(const Acceleration<B, A, P, E, T>& a) noexcept {
  Vec6<T> v;
  v << a.linear.x, a.linear.y, a.linear.z, a.angular.x, a.angular.y, a.angular.z;
  return v;
}

SKINCTL_END_NAMESPACE
