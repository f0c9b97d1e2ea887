// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a model that are known when the program is compiled.
#pragma once

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An integer known at compile time, whose `*`, `+` and `-` fold by overload.
///
/// A compiler may not drop `0 * x` (x could be NaN or negative), so the zeros and ones of a robot's
/// placements are types: `TypedConstant<0>{} * x` is `TypedConstant<0>`, `TypedConstant<1>{} * x` is `x`,
/// `TypedConstant<0>{} + x` is `x`. A NaN in `x` is dropped with it: inputs are checked where they enter the
/// cycle, not here.
template <int V>
struct TypedConstant {
  static constexpr int value = V;

  /// The number as a scalar, for storage in dense arrays.
  template <Scalar T>
  SKINCTL_INLINE constexpr explicit operator T() const noexcept {
    return T(V);
  }
  SKINCTL_INLINE constexpr TypedConstant<-V> operator-() const noexcept { return {}; }

  // Friends, so that only expressions with a TypedConstant consider them, and errors elsewhere stay short.
  template <int W>
  friend SKINCTL_INLINE constexpr TypedConstant<V * W> operator*(TypedConstant, TypedConstant<W>) noexcept {
    return {};
  }
  template <int W>
  friend SKINCTL_INLINE constexpr TypedConstant<V + W> operator+(TypedConstant, TypedConstant<W>) noexcept {
    return {};
  }
  template <int W>
  friend SKINCTL_INLINE constexpr TypedConstant<V - W> operator-(TypedConstant, TypedConstant<W>) noexcept {
    return {};
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr auto operator*(TypedConstant, const T& x) noexcept {
    if constexpr (V == 0) {
      return TypedConstant<0>{};
    } else if constexpr (V == 1) {
      return T(x);
    } else if constexpr (V == -1) {
      return T(-x);
    } else {
      return T(T(V) * x);
    }
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr auto operator*(const T& x, TypedConstant k) noexcept {
    return k * x;
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr T operator+(TypedConstant, const T& x) noexcept {
    if constexpr (V == 0) {
      return x;
    } else {
      return T(V) + x;
    }
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr T operator+(const T& x, TypedConstant k) noexcept {
    return k + x;
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr T operator-(const T& x, TypedConstant) noexcept {
    if constexpr (V == 0) {
      return x;
    } else {
      return x - T(V);
    }
  }
  template <Scalar T>
  friend SKINCTL_INLINE constexpr T operator-(TypedConstant, const T& x) noexcept {
    if constexpr (V == 0) {
      return -x;
    } else {
      return T(V) - x;
    }
  }
};

template <class X>
inline constexpr bool is_known = false;
template <int V>
inline constexpr bool is_known<TypedConstant<V>> = true;

/// Whether `X` is the type of a compile-time zero.
template <class X>
inline constexpr bool is_zero = false;
template <>
inline constexpr bool is_zero<TypedConstant<0>> = true;

/// A scalar or a compile-time number.
template <class X>
concept ScalarOrConstant = Scalar<X> || is_known<X>;

SKINCTL_END_NAMESPACE
