// The boundary to Eigen: what users pass in and get out. Eigen itself is not included here: whoever converts
// includes <Eigen/Core>, whoever does not is spared the largest part of a small file's compile time.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/core/triple.hpp"

namespace Eigen {
template <typename Scalar, int Rows, int Cols, int Options, int MaxRows, int MaxCols>
class Matrix;
template <typename Plain, int Options, typename Strides>
class Map;
template <int Outer, int Inner>
class Stride;
}  // namespace Eigen

SKINCTL_BEGIN_NAMESPACE

/// `Eigen::Matrix<T, Rows, Cols>`, column by column.
template <Scalar T, int Rows, int Cols>
using EigenMatrix = Eigen::Matrix<T, Rows, Cols, 0, Rows, Cols>;
template <class Plain>
using EigenMap = Eigen::Map<Plain, 0, Eigen::Stride<0, 0>>;
template <Scalar T>
using Vec3 = EigenMatrix<T, 3, 1>;
template <Scalar T>
using Mat3 = EigenMatrix<T, 3, 3>;
template <Scalar T>
using Vec6 = EigenMatrix<T, 6, 1>;
template <Scalar T>
using Mat6 = EigenMatrix<T, 6, 6>;

/// A joint quantity as an Eigen vector, without a copy.
template <class Kind, std::size_t N, class T>
[[nodiscard]] SKINCTL_INLINE EigenMap<EigenMatrix<T, int(N), 1>> as_eigen(
    JointVector<Kind, N, T>& v) noexcept {
  return EigenMap<EigenMatrix<T, int(N), 1>>(v.data);
}
template <class Kind, std::size_t N, class T>
[[nodiscard]] SKINCTL_INLINE EigenMap<const EigenMatrix<T, int(N), 1>> as_eigen(
    const JointVector<Kind, N, T>& v) noexcept {
  return EigenMap<const EigenMatrix<T, int(N), 1>>(v.data);
}

/// A triple as an Eigen vector.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE Vec3<T> as_eigen(const Xyz<T>& v) noexcept {
  return Vec3<T>(v.x, v.y, v.z);
}
/// An Eigen 3-vector as a triple.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE Xyz<T> as_xyz(const Vec3<T>& v) noexcept {
  return {v.x(), v.y(), v.z()};
}

SKINCTL_END_NAMESPACE
