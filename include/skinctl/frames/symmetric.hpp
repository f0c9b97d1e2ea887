// SPDX-License-Identifier: BSD-3-Clause
// A symmetric 3x3 matrix as six numbers: moments of inertia.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/frames/rotation.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A symmetric 3x3 matrix, e.g. of moments and products of inertia [kg m^2]: `xy` is the matrix's element,
/// for an inertia the negative integral of x y dm. Zero by default.
template <Scalar T = double>
struct Symmetric {
  T xx{0}, yy{0}, zz{0};
  T xy{0}, xz{0}, yz{0};

  [[nodiscard]] SKINCTL_INLINE constexpr T trace() const noexcept { return xx + yy + zz; }
  template <Scalar U>
  [[nodiscard]] SKINCTL_INLINE constexpr Symmetric<U> cast() const noexcept {
    return {static_cast<U>(xx), static_cast<U>(yy), static_cast<U>(zz),
            static_cast<U>(xy), static_cast<U>(xz), static_cast<U>(yz)};
  }
  SKINCTL_INLINE constexpr Symmetric operator+(const Symmetric& S) const noexcept {
    return {xx + S.xx, yy + S.yy, zz + S.zz, xy + S.xy, xz + S.xz, yz + S.yz};
  }
  SKINCTL_INLINE constexpr Symmetric operator-(const Symmetric& S) const noexcept {
    return {xx - S.xx, yy - S.yy, zz - S.zz, xy - S.xy, xz - S.xz, yz - S.yz};
  }
  SKINCTL_INLINE constexpr Xyz<T> operator*(const Xyz<T>& v) const noexcept {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
  friend SKINCTL_INLINE constexpr Symmetric operator*(const T& s, const Symmetric& S) noexcept {
    return {s * S.xx, s * S.yy, s * S.zz, s * S.xy, s * S.xz, s * S.yz};
  }

  /// As an Eigen matrix.
  [[nodiscard]] friend Mat3<T> as_eigen(const Symmetric& S) noexcept {
    Mat3<T> M;
    M << S.xx, S.xy, S.xz, S.xy, S.yy, S.yz, S.xz, S.yz, S.zz;
    return M;
  }

  // clang-format off
  template <EigenExpression E> void operator=(const E&) = delete;  // from Eigen: as_symmetric(M)
  template <EigenExpression E> operator E() const = delete;  // to Eigen: as_eigen(x)
  // clang-format on
};

/// `|v|^2 1 - v v^T`: the inertia of a unit mass at `v` about the origin.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr Symmetric<T> unit_mass_at(const Xyz<T>& v) noexcept {
  return {v.y * v.y + v.z * v.z,
          v.z * v.z + v.x * v.x,
          v.x * v.x + v.y * v.y,
          -v.x * v.y,
          -v.x * v.z,
          -v.y * v.z};
}
/// `R_AB S_B R_AB^T = S_A`.
template <Scalar T>
[[nodiscard]] SKINCTL_INLINE constexpr Symmetric<T> rotated(const Rotation<T>& R_AB,
                                                            const Symmetric<T>& S_B) noexcept {
  const Rotation<T> rows = R_AB.transpose();
  const Xyz<T> x = S_B * rows.x, y = S_B * rows.y, z = S_B * rows.z;
  return {dot(rows.x, x), dot(rows.y, y), dot(rows.z, z), dot(rows.x, y), dot(rows.x, z), dot(rows.y, z)};
}

/// From an Eigen matrix, 3x3. Elements that differ across the diagonal by rounding are averaged.
template <VectorExpression E>
[[nodiscard]] Symmetric<typename E::Scalar> as_symmetric(const E& values) noexcept {
  using T = typename E::Scalar;
  const Mat3<T> M = values;
  const T half(0.5);
  return {M(0, 0),
          M(1, 1),
          M(2, 2),
          half * (M(0, 1) + M(1, 0)),
          half * (M(0, 2) + M(2, 0)),
          half * (M(1, 2) + M(2, 1))};
}

/// The three eigenvalues in ascending order, by cyclic Jacobi rotations; each to within a few units in the
/// last place of the largest. A NaN gives NaNs. For configuration time: about 15 square roots.
template <Real T>
[[nodiscard]] Xyz<T> eigenvalues(Symmetric<T> S) noexcept {
  const auto annihilate = [](T& pp, T& qq, T& pq, T& pr, T& qr) {
    using std::abs;
    using std::sqrt;
    if (pq == T(0)) return;
    const T theta = (qq - pp) / (T(2) * pq);
    const T t = (theta < T(0) ? T(-1) : T(1)) / (abs(theta) + sqrt(theta * theta + T(1)));
    const T c = T(1) / sqrt(t * t + T(1)), s = t * c;
    pp = pp - t * pq;
    qq = qq + t * pq;
    pq = T(0);
    const T r = c * pr - s * qr;
    qr = s * pr + c * qr;
    pr = r;
  };
  for (int sweep = 0; sweep < 12; ++sweep) {  // converges quadratically: 5 for double, 7 for 50 digits
    annihilate(S.xx, S.yy, S.xy, S.xz, S.yz);
    annihilate(S.xx, S.zz, S.xz, S.xy, S.yz);
    annihilate(S.yy, S.zz, S.yz, S.xy, S.xz);
  }
  const auto order = [](T& a, T& b) {
    if (b < a) {
      const T c = a;
      a = b;
      b = c;
    }
  };
  order(S.xx, S.yy);
  order(S.yy, S.zz);
  order(S.xx, S.yy);
  return {S.xx, S.yy, S.zz};
}

SKINCTL_END_NAMESPACE
