// SPDX-License-Identifier: BSD-3-Clause
// Acceleration of a rigid body. The type names the body, the reference frame, the point and the axes.
#pragma once

#include "skinctl/frames/twist.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rate of change of a `Twist` with the same template arguments: the acceleration of the body's point that is
/// at the origin of `At` now and moves with the body, and the angular acceleration. An accelerometer at that
/// point measures it, gravity apart; it is not the "spatial" acceleration of screw theory. Zero by default.
template <Frame Body, Frame Relative, Frame At = Body, Frame Axes = Relative, Scalar T = double>
struct Acceleration {
  Xyz<T> linear{T(0), T(0), T(0)};   ///< acceleration of the body's point at the origin of `At` [m/s^2]
  Xyz<T> angular{T(0), T(0), T(0)};  ///< angular acceleration [rad/s^2]

  /// An acceleration from an Eigen vector of six numbers, linear part first.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Acceleration from_eigen(const V& v) noexcept {
    return detail::from_six<Acceleration, T>(v);
  }
  /// The six numbers as an Eigen vector, linear part first.
  [[nodiscard]] friend Vec6<T> as_eigen(const Acceleration& a) noexcept {
    return detail::six(a.linear, a.angular);
  }
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
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Acceleration<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // other body, point or axes, or no acceleration
  template <class Q> void operator-(const Q&) const = delete;  // other body, point or axes, or no acceleration
  // clang-format on
};

SKINCTL_END_NAMESPACE
