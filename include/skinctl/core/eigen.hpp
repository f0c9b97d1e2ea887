// SPDX-License-Identifier: BSD-3-Clause
// Conversion between skinctl's types and Eigen's. Eigen is not included here: a file that converts includes
// <Eigen/Core> (for poses <Eigen/Geometry>); any other file saves the largest part of its compile time.
#pragma once

#include <limits>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/triple.hpp"

SKINCTL_BEGIN_NAMESPACE

// Every quantity becomes an Eigen object by `as_eigen(x)`, and is built from one by a constructor that names
// the quantity (`JointTorque<6>(v)`, `Transform<Base, Tool>(X)`), or, where the type is an aggregate, by its
// `from_eigen` (`Wrench<Forearm>::from_eigen(v)`). `as_eigen` of joint vectors and matrices is a view, so a
// temporary is refused; everything else is copied.

/// A triple as an Eigen vector.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE Vec3<T> as_eigen(const Xyz<T>& v) noexcept {
  return Vec3<T>(v.x, v.y, v.z);
}

namespace detail {
/// Elements `first` to `first + 2` of an evaluated vector.
template <class V>
[[nodiscard]] SKINCTL_INLINE Xyz<typename V::Scalar> three(const V& v, int first) noexcept {
  return {v.coeff(first), v.coeff(first + 1), v.coeff(first + 2)};
}
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE Xyz<T> no_numbers() noexcept {
  const T nan = std::numeric_limits<T>::quiet_NaN();
  return {nan, nan, nan};
}
/// A `Q` of two triples from six numbers; from another number of them a `Q` of NaN.
template <class Q, Scalar T, class V>
[[nodiscard]] SKINCTL_INLINE Q from_six(const V& values) noexcept {
  static_assert(std::is_same_v<typename V::Scalar, T>, "other scalar: v.cast<T>()");
  static_assert(int(V::SizeAtCompileTime) == 6 || int(V::SizeAtCompileTime) == -1, "six numbers");
  if (values.size() != 6) return {no_numbers<T>(), no_numbers<T>()};
  const auto v = values.eval();
  return {three(v, 0), three(v, 3)};
}
/// Six numbers, one triple after the other.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE Vec6<T> six(const Xyz<T>& a, const Xyz<T>& b) noexcept {
  Vec6<T> v;
  v << a.x, a.y, a.z, b.x, b.y, b.z;
  return v;
}
}  // namespace detail

/// An Eigen vector of three elements as a triple; a dynamic one of another size gives NaN.
template <VectorExpression V>
[[nodiscard]] SKINCTL_INLINE Xyz<typename V::Scalar> as_xyz(const V& values) noexcept {
  static_assert(int(V::SizeAtCompileTime) == 3 || int(V::SizeAtCompileTime) == -1, "three numbers");
  if (values.size() != 3) return detail::no_numbers<typename V::Scalar>();
  return detail::three(values.eval(), 0);
}

SKINCTL_END_NAMESPACE
