// The boundary to Eigen: what users pass in and get out.
#pragma once

#include <Eigen/Core>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/triple.hpp"

SKINCTL_BEGIN_NAMESPACE

template <Scalar T>
using Vec3 = Eigen::Matrix<T, 3, 1>;
template <Scalar T>
using Mat3 = Eigen::Matrix<T, 3, 3>;
template <Scalar T>
using Vec6 = Eigen::Matrix<T, 6, 1>;
template <Scalar T>
using Mat6 = Eigen::Matrix<T, 6, 6>;

/// A joint quantity as an Eigen vector, without a copy.
template <class Kind, std::size_t N, class T>
[[nodiscard]] SKINCTL_INLINE Eigen::Map<Eigen::Matrix<T, int(N), 1>> as_eigen(
    JointVector<Kind, N, T>& v) noexcept {
  return Eigen::Map<Eigen::Matrix<T, int(N), 1>>(v.data);
}
template <class Kind, std::size_t N, class T>
[[nodiscard]] SKINCTL_INLINE Eigen::Map<const Eigen::Matrix<T, int(N), 1>> as_eigen(
    const JointVector<Kind, N, T>& v) noexcept {
  return Eigen::Map<const Eigen::Matrix<T, int(N), 1>>(v.data);
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
