// SPDX-License-Identifier: BSD-3-Clause
// The inverse of a Jacobian of six joints, in blocks of three.
#pragma once

#include "skinctl/kinematics/jacobian.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `[A B; C D]^-1` from the inverses of D and of its Schur complement `S = A - B D^-1 C`, each by three cross
/// products and one division: neither pivots nor the long chain of a factorisation, and the condition number
/// of the matrix instead of its square. D are the axes of the last three joints.
template <Real T>
class BlockInverse {
 public:
  /// @param J  a Jacobian that six joints move.
  template <class J>
  SKINCTL_INLINE explicit BlockInverse(const J& jacobian) noexcept {
    Xyz<T> l[6], a[6];
    std::size_t n = 0;
    jacobian.for_each([&](auto, const auto& c)
                          SKINCTL_INLINE_LAMBDA { l[n] = c.linear, a[n] = c.angular, ++n; });
    const Xyz<T> first = cross(a[4], a[5]);
    const T det = dot(a[3], first);
    usable_ = det * det > T(1e-4) * (dot(a[3], a[3]) * dot(a[4], a[4]) * dot(a[5], a[5]));
    const T per_det = T(1) / (usable_ ? det : T(1));
    r_[0] = per_det * first;
    r_[1] = per_det * cross(a[5], a[3]);
    r_[2] = per_det * cross(a[3], a[4]);
    Xyz<T> s[3];
    unrolled<3>([&](auto k) SKINCTL_INLINE_LAMBDA {
      b_[k] = l[3 + k];
      e_[k] = rows(r_, a[k]);
    });
    unrolled<3>([&](auto k) SKINCTL_INLINE_LAMBDA { s[k] = l[k] - combined(b_, e_[k]); });
    const Xyz<T> second = cross(s[1], s[2]);
    const T det_s = dot(s[0], second);
    const T per_det_s = T(det_s == T(0) ? 0 : 1) / (det_s == T(0) ? T(1) : det_s);
    p_[0] = per_det_s * second;
    p_[1] = per_det_s * cross(s[2], s[0]);
    p_[2] = per_det_s * cross(s[0], s[1]);
    determinant_ = det * det_s;
  }
  /// Whether D can be inverted: its volume is more than a hundredth of that of a box. Otherwise, and with a
  /// NaN in D, nothing else is defined.
  [[nodiscard]] SKINCTL_INLINE bool usable() const noexcept { return usable_; }
  [[nodiscard]] SKINCTL_INLINE const T& determinant() const noexcept { return determinant_; }

  /// Solves `J x = (linear, angular)`.
  SKINCTL_INLINE void solve(const Xyz<T>& linear, const Xyz<T>& angular, T (&x)[6]) const noexcept {
    const Xyz<T> g = rows(r_, angular);
    const Xyz<T> y = rows(p_, Xyz<T>(linear - combined(b_, g)));
    const Xyz<T> z = g - combined(e_, y);
    x[0] = y.x, x[1] = y.y, x[2] = y.z, x[3] = z.x, x[4] = z.y, x[5] = z.z;
  }
  /// Solves `J' (linear, angular) = t`.
  SKINCTL_INLINE void solve_transposed(const T (&t)[6], Xyz<T>& linear, Xyz<T>& angular) const noexcept {
    const Xyz<T> low{t[3], t[4], t[5]};
    linear = combined(p_, Xyz<T>(Xyz<T>{t[0], t[1], t[2]} - rows(e_, low)));
    angular = combined(r_, Xyz<T>(low - rows(b_, linear)));
  }

 private:
  static SKINCTL_INLINE Xyz<T> rows(const Xyz<T> (&m)[3], const Xyz<T>& v) noexcept {
    return {T(dot(m[0], v)), T(dot(m[1], v)), T(dot(m[2], v))};
  }
  static SKINCTL_INLINE Xyz<T> combined(const Xyz<T> (&m)[3], const Xyz<T>& v) noexcept {
    SKINCTL_CONTRACT return {T(v.x * m[0].x + v.y * m[1].x + v.z * m[2].x),
                             T(v.x * m[0].y + v.y * m[1].y + v.z * m[2].y),
                             T(v.x * m[0].z + v.y * m[1].z + v.z * m[2].z)};
  }

  Xyz<T> b_[3];  // columns of B
  Xyz<T> r_[3];  // rows of D^-1
  Xyz<T> e_[3];  // columns of D^-1 C
  Xyz<T> p_[3];  // rows of S^-1
  T determinant_;
  bool usable_;
};

/// Stands in for `BlockInverse` where the Jacobian has another shape.
struct NoBlockInverse {
  template <class J>
  explicit NoBlockInverse(const J&) noexcept {}
};

}  // namespace detail
SKINCTL_END_NAMESPACE
