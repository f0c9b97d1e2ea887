// SPDX-License-Identifier: BSD-3-Clause
// Points and vectors whose coordinate frame is part of the type.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/core/triple.hpp"
#include "skinctl/frames/frame.hpp"

SKINCTL_BEGIN_NAMESPACE

// Meaningless operations are deleted, with a hint on the line that bears the operator's name: compilers print
// that line, and those of all other candidates. So operators are members and friends, which keeps the
// candidates few.

/// A vector with direction and magnitude but no point of application (a displacement, a velocity, a force),
/// along the axes of `A`.
template <Frame A, Scalar T = double>
struct FreeVector {
  Xyz<T> xyz{T(0), T(0), T(0)};

  /// From an Eigen vector of three numbers.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static FreeVector from_eigen(const V& v) noexcept {
    return {as_xyz(v)};
  }
  /// The three coordinates as an Eigen vector.
  [[nodiscard]] friend Vec3<T> as_eigen(const FreeVector& p) noexcept { return as_eigen(p.xyz); }

  SKINCTL_INLINE constexpr FreeVector operator+(const FreeVector& v) const noexcept { return {xyz + v.xyz}; }
  SKINCTL_INLINE constexpr FreeVector operator-(const FreeVector& v) const noexcept { return {xyz - v.xyz}; }
  SKINCTL_INLINE constexpr FreeVector operator-() const noexcept { return {-xyz}; }
  friend SKINCTL_INLINE constexpr FreeVector operator*(const T& s, const FreeVector& u) noexcept {
    return {s * u.xyz};
  }
  friend SKINCTL_INLINE constexpr T dot(const FreeVector& u, const FreeVector& v) noexcept {
    return dot(u.xyz, v.xyz);
  }
  friend SKINCTL_INLINE T norm(const FreeVector& u) noexcept
    requires Real<T>
  {
    return norm(u.xyz);
  }
  friend SKINCTL_INLINE constexpr FreeVector cross(const FreeVector& u, const FreeVector& v) noexcept {
    return {cross(u.xyz, v.xyz)};
  }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: FreeVector<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // vectors along other axes: X_AB * v first
  template <class Q> void operator-(const Q&) const = delete;  // vectors along other axes: X_AB * v first
  template <class B, class U> friend void dot(const FreeVector&, const FreeVector<B, U>&) = delete;  // X_AB * v first
  template <class B, class U> friend void cross(const FreeVector&, const FreeVector<B, U>&) = delete;  // X_AB * v first
  // clang-format on
};

/// A point: its coordinates [m] from the origin of `A` along the axes of `A`. Points have a difference, no
/// sum.
template <Frame A, Scalar T = double>
struct Point {
  Xyz<T> xyz{T(0), T(0), T(0)};

  /// From an Eigen vector of three numbers.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Point from_eigen(const V& v) noexcept {
    return {as_xyz(v)};
  }
  /// The three coordinates as an Eigen vector.
  [[nodiscard]] friend Vec3<T> as_eigen(const Point& p) noexcept { return as_eigen(p.xyz); }

  /// From `b` to this point.
  SKINCTL_INLINE constexpr FreeVector<A, T> operator-(const Point& b) const noexcept { return {xyz - b.xyz}; }
  SKINCTL_INLINE constexpr Point operator+(const FreeVector<A, T>& v) const noexcept { return {xyz + v.xyz}; }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Point<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Q> void operator+(const Q&) const = delete;  // two points have no sum
  template <class Q> void operator-(const Q&) const = delete;  // points of two frames: X_AB * p first
  // clang-format on
};

/// `p_PQ_E`: from the origin of `P` to the origin of `Q` [m], along the axes of `E`. Chains like transforms:
/// `p_PQ_E + p_QR_E` is `p_PR_E`, and `-p_PQ_E` is `p_QP_E`.
template <Frame P, Frame Q, Frame E, Scalar T = double>
struct Offset {
  Xyz<T> xyz{T(0), T(0), T(0)};

  /// From an Eigen vector of three numbers.
  template <VectorExpression V>
  [[nodiscard]] SKINCTL_INLINE static Offset from_eigen(const V& v) noexcept {
    return {as_xyz(v)};
  }
  /// The three coordinates as an Eigen vector.
  [[nodiscard]] friend Vec3<T> as_eigen(const Offset& p) noexcept { return as_eigen(p.xyz); }

  template <Frame R>
  SKINCTL_INLINE constexpr Offset<P, R, E, T> operator+(const Offset<Q, R, E, T>& p_QR_E) const noexcept {
    return {xyz + p_QR_E.xyz};
  }
  SKINCTL_INLINE constexpr Offset<Q, P, E, T> operator-() const noexcept { return {-xyz}; }

  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: Offset<...>::from_eigen(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(x)
  template <class Z> void operator+(const Z&) const = delete;  // no chain p_PQ_E + p_QR_E
  // clang-format on
};

template <class X>
inline constexpr bool is_offset = false;
template <class P, class Q, class E, class T>
inline constexpr bool is_offset<Offset<P, Q, E, T>> = true;
template <class X>
concept AnyOffset = is_offset<X>;

SKINCTL_END_NAMESPACE
