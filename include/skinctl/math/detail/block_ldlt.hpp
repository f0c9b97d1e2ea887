// SPDX-License-Identifier: BSD-3-Clause
// Solutions with a symmetric positive definite 6 x 6 matrix, in blocks of three.
#pragma once

#include <limits>

#include "skinctl/core/triple.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// `[A B'; B C] x = b` by the inverses of C and of `S = A - B' C^-1 B`, each by its cofactors and one
/// division: two of these in a row where `Ldlt` has six, and half of its time where one result waits for the
/// other. Scaling of rows and columns changes nothing but the rounding; the error is that of `Ldlt`. A pivot
/// as in `Ldlt` that is too small gives `positive_definite() == false`, and then the solution is not defined,
/// but nothing is divided by zero.
template <Real T>
class BlockLdlt {
 public:
  /// @param a  36 numbers, row by row; only the lower triangle is read.
  SKINCTL_INLINE explicit BlockLdlt(const T* a) noexcept
      : b_{{a[18], a[24], a[30]}, {a[19], a[25], a[31]}, {a[20], a[26], a[32]}} {
    const T diagonal_c[3] = {a[21], a[28], a[35]}, diagonal_a[3] = {a[0], a[7], a[14]};
    const bool lower = invert({a[21], a[27], a[28], a[33], a[34], a[35]}, diagonal_c, c_);
    for_three([&](auto k) SKINCTL_INLINE_LAMBDA { e_[k] = c_ * b_[k]; });
    const bool upper =
        invert({T(a[0] - dot(b_[0], e_[0])), T(a[6] - dot(b_[1], e_[0])), T(a[7] - dot(b_[1], e_[1])),
                T(a[12] - dot(b_[2], e_[0])), T(a[13] - dot(b_[2], e_[1])), T(a[14] - dot(b_[2], e_[2]))},
               diagonal_a, s_);
    positive_definite_ = lower && upper;
  }
  [[nodiscard]] SKINCTL_INLINE bool positive_definite() const noexcept { return positive_definite_; }

  /// Solves the system; `x` may be `b`.
  /// @tparam B  numbers, or rows of them: several right sides at once.
  template <class B>
  SKINCTL_INLINE void solve(const B* b, B* x) const noexcept {
    SKINCTL_CONTRACT
    B g[3], y[3], rest[3];
    c_.times(b[3], b[4], b[5], g);
    for_three([&](auto k) SKINCTL_INLINE_LAMBDA {
      rest[k] = b[k] - (b_[k].x * g[0] + b_[k].y * g[1] + b_[k].z * g[2]);
    });
    s_.times(rest[0], rest[1], rest[2], y);
    x[0] = y[0], x[1] = y[1], x[2] = y[2];
    x[3] = g[0] - (e_[0].x * y[0] + e_[1].x * y[1] + e_[2].x * y[2]);
    x[4] = g[1] - (e_[0].y * y[0] + e_[1].y * y[1] + e_[2].y * y[2]);
    x[5] = g[2] - (e_[0].z * y[0] + e_[1].z * y[1] + e_[2].z * y[2]);
  }

 private:
  /// The lower triangle of a symmetric 3 x 3 matrix.
  struct Symmetric {
    T xx, yx, yy, zx, zy, zz;
    template <class B>
    SKINCTL_INLINE void times(const B& x, const B& y, const B& z, B (&out)[3]) const noexcept {
      SKINCTL_CONTRACT
      out[0] = xx * x + yx * y + zx * z;
      out[1] = yx * x + yy * y + zy * z;
      out[2] = zx * x + zy * y + zz * z;
    }
    SKINCTL_INLINE Xyz<T> operator*(const Xyz<T>& v) const noexcept {
      SKINCTL_CONTRACT return {T(xx * v.x + yx * v.y + zx * v.z), T(yx * v.x + yy * v.y + zy * v.z),
                               T(zx * v.x + zy * v.y + zz * v.z)};
    }
  };
  template <class F>
  static SKINCTL_INLINE void for_three(F&& f) noexcept {
    skinctl::detail::unrolled<3>(f);
  }
  /// Inverts `m`. False if a pivot, taken from the last one on, is at most `8 epsilon` of the element in
  /// `whole`.
  static SKINCTL_INLINE bool invert(const Symmetric& m, const T (&whole)[3], Symmetric& inverse) noexcept {
    SKINCTL_CONTRACT
    const T xx = m.yy * m.zz - m.zy * m.zy, yx = m.zx * m.zy - m.yx * m.zz, zx = m.yx * m.zy - m.zx * m.yy;
    const T det = m.xx * xx + m.yx * yx + m.zx * zx;
    const T small = T(8) * std::numeric_limits<T>::epsilon();
    // All three in any case, without a branch.
    const bool good = (int(m.zz > small * whole[2]) & int(xx > small * (whole[1] * m.zz)) &
                       int(det > small * (whole[0] * xx))) != 0;
    const T per_det = T(1) / (good ? det : T(1));
    inverse = {xx * per_det,
               yx * per_det,
               (m.xx * m.zz - m.zx * m.zx) * per_det,
               zx * per_det,
               (m.yx * m.zx - m.xx * m.zy) * per_det,
               (m.xx * m.yy - m.yx * m.yx) * per_det};
    return good;
  }

  Xyz<T> b_[3];      // columns of B
  Xyz<T> e_[3];      // columns of C^-1 B
  Symmetric c_, s_;  // C^-1, S^-1
  bool positive_definite_;
};

/// The faster of `BlockLdlt` and `Ldlt` for one system of `N` equations.
template <std::size_t N, Real T>
using OneSystem = std::conditional_t<N == 6, BlockLdlt<T>, Ldlt<N, T>>;

}  // namespace math::detail
SKINCTL_END_NAMESPACE
