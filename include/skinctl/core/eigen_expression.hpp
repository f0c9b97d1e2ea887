// SPDX-License-Identifier: BSD-3-Clause
// Forward declarations of Eigen's types, and concepts that recognise Eigen by its interface, without
// including it.
#pragma once

#include "skinctl/core/real.hpp"

namespace Eigen {
template <typename Scalar, int Rows, int Cols, int Options, int MaxRows, int MaxCols>
class Matrix;
template <typename Plain, int Options, typename Strides>
class Map;
template <int Outer, int Inner>
class Stride;
template <typename Scalar, int Dim, int Mode, int Options>
class Transform;
template <typename Scalar, int Options>
class Quaternion;
template <typename Matrix>
class SelfAdjointEigenSolver;
template <typename Matrix>
class GeneralizedSelfAdjointEigenSolver;
}  // namespace Eigen

SKINCTL_BEGIN_NAMESPACE

/// `Eigen::Matrix<T, Rows, Cols>`, column-major.
template <Scalar T, int Rows, int Cols>
using EigenMatrix = Eigen::Matrix<T, Rows, Cols, 0, Rows, Cols>;
template <class Plain>
using EigenMap = Eigen::Map<Plain, 0, Eigen::Stride<0, 0>>;
/// `Eigen::Isometry3<T>`.
template <Scalar T>
using EigenIsometry = Eigen::Transform<T, 3, 1, 0>;
template <Scalar T>
using Vec3 = EigenMatrix<T, 3, 1>;
template <Scalar T>
using Mat3 = EigenMatrix<T, 3, 3>;
template <Scalar T>
using Vec6 = EigenMatrix<T, 6, 1>;
template <Scalar T>
using Mat6 = EigenMatrix<T, 6, 6>;

/// A matrix, vector or expression of Eigen's.
template <class V>
concept EigenExpression = requires { typename V::PlainObject; };
/// An array, a vector, a span: numbers without a kind.
template <class V>
concept BareNumbers = !EigenExpression<V> && requires(const V& v) { v.data() + v.size(); };
/// Whether one of the types is an Eigen expression: as a constant, about which Clang writes one line where it
/// writes four of a concept.
template <class... V>
inline constexpr bool any_eigen = (EigenExpression<V> || ...);

/// A transform of Eigen's; Eigen/Geometry is not included here.
template <class X>
concept EigenPose = requires { typename X::LinearMatrixType; };
/// `EigenPose` as a constant.
template <class X>
inline constexpr bool is_eigen_pose = EigenPose<X>;

/// An Eigen expression that has elements to read.
template <class V>
concept VectorExpression = EigenExpression<V> && requires(const V& v) {
  v.eval();
  v.size();
};

SKINCTL_END_NAMESPACE
