// SPDX-License-Identifier: BSD-3-Clause
// Three numbers along x, y and z, each a scalar or a compile-time constant: the vectors of the loop.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/core/eigen_expression.hpp"
#include "skinctl/core/known.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A 3-vector whose components may be typed constants. Algorithms use it instead of Eigen's, whose packet
/// code for three elements is about a third slower on GCC; Eigen is used at the interfaces
/// (`core/eigen.hpp`).
template <ScalarOrConstant X, ScalarOrConstant Y = X, ScalarOrConstant Z = X>
struct Triple {
  [[no_unique_address]] X x;
  [[no_unique_address]] Y y;
  [[no_unique_address]] Z z;

  template <class A, class B, class C>
  friend SKINCTL_INLINE constexpr auto operator+(const Triple& u, const Triple<A, B, C>& v) noexcept {
    SKINCTL_CONTRACT return skinctl::Triple{u.x + v.x, u.y + v.y, u.z + v.z};
  }
  template <class A, class B, class C>
  friend SKINCTL_INLINE constexpr auto operator-(const Triple& u, const Triple<A, B, C>& v) noexcept {
    SKINCTL_CONTRACT return skinctl::Triple{u.x - v.x, u.y - v.y, u.z - v.z};
  }
  friend SKINCTL_INLINE constexpr auto operator-(const Triple& u) noexcept {
    SKINCTL_CONTRACT return skinctl::Triple{-u.x, -u.y, -u.z};
  }
  template <ScalarOrConstant S>
  friend SKINCTL_INLINE constexpr auto operator*(const S& s, const Triple& v) noexcept {
    SKINCTL_CONTRACT return skinctl::Triple{s * v.x, s * v.y, s * v.z};
  }
  friend SKINCTL_INLINE constexpr bool operator==(const Triple& u, const Triple& v) noexcept
    requires(Real<X> && Real<Y> && Real<Z>)
  {
    return u.x == v.x && u.y == v.y && u.z == v.z;
  }
  // clang-format off
  template <EigenExpression V> void operator=(const V&) = delete;  // from Eigen: as_xyz(v)
  template <EigenExpression V> operator V() const = delete;  // to Eigen: as_eigen(p)
  // clang-format on
};
template <class X, class Y, class Z>
Triple(X, Y, Z) -> Triple<X, Y, Z>;

/// A dense 3-vector.
template <Scalar T>
using Xyz = Triple<T, T, T>;

using ZeroTriple = Triple<TypedConstant<0>, TypedConstant<0>, TypedConstant<0>>;
using UnitZ = Triple<TypedConstant<0>, TypedConstant<0>, TypedConstant<1>>;

/// The same vector with every component stored as `T`.
template <Scalar T, class X, class Y, class Z>
SKINCTL_INLINE constexpr Xyz<T> dense(const Triple<X, Y, Z>& v) noexcept {
  return {T(v.x), T(v.y), T(v.z)};
}

/// The same vector, copied component by component, for a member of an aggregate: GCC copies a whole vector in
/// pieces of 16 bytes and more, and such a load waits for the stores of the components.
template <class X, class Y, class Z>
SKINCTL_INLINE constexpr Triple<X, Y, Z> by_component(const Triple<X, Y, Z>& v) noexcept {
  return {v.x, v.y, v.z};
}
/// Writes `v` to `to`, component by component.
template <Scalar T, class X, class Y, class Z>
SKINCTL_INLINE constexpr void assign(Xyz<T>& to, const Triple<X, Y, Z>& v) noexcept {
  to.x = T(v.x);
  to.y = T(v.y);
  to.z = T(v.z);
}

/// The same vector in another scalar.
template <Scalar U, Scalar T>
SKINCTL_INLINE constexpr Xyz<U> cast(const Xyz<T>& v) noexcept {
  return {static_cast<U>(v.x), static_cast<U>(v.y), static_cast<U>(v.z)};
}

template <class A, class B, class C, class D, class E, class F>
SKINCTL_INLINE constexpr auto dot(const Triple<A, B, C>& u, const Triple<D, E, F>& v) noexcept {
  SKINCTL_CONTRACT return u.x * v.x + u.y * v.y + u.z * v.z;
}
template <class A, class B, class C, class D, class E, class F>
SKINCTL_INLINE constexpr auto cross(const Triple<A, B, C>& u, const Triple<D, E, F>& v) noexcept {
  SKINCTL_CONTRACT return Triple{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// `|v|`, also where the squares underflow or overflow: a vector of 1e-200 has a length. A NaN gives a NaN.
template <Real T>
[[nodiscard]] T norm(const Xyz<T>& v) noexcept {
  using std::abs;
  using std::sqrt;
  const T square = dot(v, v);
  if (square > std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon() &&
      square < (std::numeric_limits<T>::max)())
    return sqrt(square);
  const T ax = abs(v.x), ay = abs(v.y), az = abs(v.z);
  T largest = ax > ay ? ax : ay;
  if (!(largest >= az)) largest = az;
  if (!(largest > T(0))) return square;  // zero, or a NaN that has to stay visible
  const Xyz<T> unit{v.x / largest, v.y / largest, v.z / largest};
  return T(largest * sqrt(dot(unit, unit)));
}

/// A rotation about one axis by a known cosine and sine, either of which may be a typed constant.
template <ScalarOrConstant C, ScalarOrConstant S>
struct Turn {
  [[no_unique_address]] C cos;
  [[no_unique_address]] S sin;
};
template <class C, class S>
Turn(C, S) -> Turn<C, S>;

/// `Rz(turn) v`: coordinates in the turned frame to coordinates in the frame it turned from.
template <class C, class S, class X, class Y, class Z>
SKINCTL_INLINE constexpr auto turn_z(const Turn<C, S>& t, const Triple<X, Y, Z>& v) noexcept {
  SKINCTL_CONTRACT return Triple{t.cos * v.x - t.sin * v.y, t.sin * v.x + t.cos * v.y, v.z};
}
/// `Rz(turn)^T v`: coordinates in the frame it turned from to coordinates in the turned frame.
template <class C, class S, class X, class Y, class Z>
SKINCTL_INLINE constexpr auto turn_back_z(const Turn<C, S>& t, const Triple<X, Y, Z>& v) noexcept {
  SKINCTL_CONTRACT return Triple{t.cos * v.x + t.sin * v.y, t.cos * v.y - t.sin * v.x, v.z};
}
/// `Rx(turn) v`: coordinates in the turned frame to coordinates in the frame it turned from.
template <class C, class S, class X, class Y, class Z>
SKINCTL_INLINE constexpr auto turn_x(const Turn<C, S>& t, const Triple<X, Y, Z>& v) noexcept {
  SKINCTL_CONTRACT return Triple{v.x, t.cos * v.y - t.sin * v.z, t.sin * v.y + t.cos * v.z};
}
/// `Rx(turn)^T v`: coordinates in the frame it turned from to coordinates in the turned frame.
template <class C, class S, class X, class Y, class Z>
SKINCTL_INLINE constexpr auto turn_back_x(const Turn<C, S>& t, const Triple<X, Y, Z>& v) noexcept {
  SKINCTL_CONTRACT return Triple{v.x, t.cos * v.y + t.sin * v.z, t.cos * v.z - t.sin * v.y};
}

SKINCTL_END_NAMESPACE
