// SPDX-License-Identifier: BSD-3-Clause
// A symmetric 3x3 matrix as six numbers: moments of inertia.
#pragma once

#include "skinctl/frames/rotation.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A symmetric 3x3 matrix, e.g. of moments and products of inertia [kg m^2]: `xy` is the matrix's element,
/// for an inertia the negative integral of x y dm. Zero by default.
template <Scalar T = double>
struct Symmetric {
  T xx{0}, yy{0}, zz{0};
  T xy{0}, xz{0}, yz{0};

  [[nodiscard]] SKINCTL_INLINE constexpr T trace() const noexcept { return xx + yy + zz; }
};

/// The three eigenvalues of `S` in ascending order, by cyclic Jacobi rotations; each to within a few units in
/// the last place of the largest. A NaN gives NaNs. For configuration time: about 15 square roots.
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
