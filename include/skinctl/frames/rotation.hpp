// SPDX-License-Identifier: BSD-3-Clause
// A rotation matrix as three axes of plain numbers, and the rotation vector: exp, log and their derivatives.
#pragma once

#include "skinctl/core/eigen.hpp"
#include "skinctl/core/triple.hpp"
#include "skinctl/frames/detail/rotation_series.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `R_AB` without the frames in the type: the axes of B in coordinates of A, the columns of the matrix.
/// `Transform` is the typed form; this one is for the algorithms beneath it. Identity by default.
template <Scalar T = double>
struct Rotation {
  Xyz<T> x{T(1), T(0), T(0)};
  Xyz<T> y{T(0), T(1), T(0)};
  Xyz<T> z{T(0), T(0), T(1)};

  /// The rotation of an Eigen matrix, 3x3; a dynamic one of another size gives NaN. Not checked to be one.
  template <VectorExpression E>
  [[nodiscard]] static Rotation from_eigen(const E& R_AB) noexcept {
    static_assert(std::is_same_v<typename E::Scalar, T>, "other scalar: R.cast<T>()");
    if (R_AB.rows() != 3 || R_AB.cols() != 3) {
      const auto none = detail::no_numbers<T>();
      return {none, none, none};
    }
    const Mat3<T> R = R_AB;
    return {{R(0, 0), R(1, 0), R(2, 0)}, {R(0, 1), R(1, 1), R(2, 1)}, {R(0, 2), R(1, 2), R(2, 2)}};
  }
  /// `R_BA`, the inverse.
  [[nodiscard]] SKINCTL_INLINE constexpr Rotation transpose() const noexcept {
    return {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
  }
  /// `v_A = R_AB v_B`. Written per component: Clang fuses multiply-adds only within one expression.
  template <class X, class Y, class Z>
  [[nodiscard]] SKINCTL_INLINE constexpr Xyz<T> operator*(const Triple<X, Y, Z>& v) const noexcept {
    return {T(x.x * v.x + y.x * v.y + z.x * v.z), T(x.y * v.x + y.y * v.y + z.y * v.z),
            T(x.z * v.x + y.z * v.y + z.z * v.z)};
  }
  /// `R_AC = R_AB R_BC`.
  [[nodiscard]] SKINCTL_INLINE constexpr Rotation operator*(const Rotation& R_BC) const noexcept {
    return {*this * R_BC.x, *this * R_BC.y, *this * R_BC.z};
  }
  friend SKINCTL_INLINE constexpr bool operator==(const Rotation& R, const Rotation& S) noexcept {
    return R.x == S.x && R.y == S.y && R.z == S.z;
  }

  /// The matrix `R_AB`.
  [[nodiscard]] friend Mat3<T> as_eigen(const Rotation& R) noexcept {
    Mat3<T> M;
    M << R.x.x, R.y.x, R.z.x, R.x.y, R.y.y, R.z.y, R.x.z, R.y.z, R.z.z;
    return M;
  }

  // clang-format off
  template <EigenExpression E> void operator=(const E&) = delete;  // from Eigen: Rotation<T>::from_eigen(R)
  template <EigenExpression E> operator E() const = delete;  // to Eigen: as_eigen(x)
  // clang-format on
};

/// `v_B = R_AB^T v_A`: the vector in coordinates of B.
template <class T, class X, class Y, class Z>
[[nodiscard]] SKINCTL_INLINE constexpr Xyz<T> turn_back(const Rotation<T>& R,
                                                        const Triple<X, Y, Z>& v) noexcept {
  return {T(dot(R.x, v)), T(dot(R.y, v)), T(dot(R.z, v))};
}
/// The largest element of `|R^T R - 1|`, plus 1 if the axes are left-handed: 0 for a rotation. A NaN gives a
/// NaN.
template <Real T>
[[nodiscard]] constexpr T rotation_error(const Rotation<T>& R) noexcept {
  T worst(0);
  const T errors[] = {dot(R.x, R.x) - T(1), dot(R.y, R.y) - T(1), dot(R.z, R.z) - T(1),
                      dot(R.x, R.y),        dot(R.y, R.z),        dot(R.z, R.x)};
  for (const T& e : errors) {
    const T size = e < T(0) ? T(-e) : e;
    if (worst == worst && !(size <= worst)) worst = size;
  }
  return dot(cross(R.x, R.y), R.z) < T(0) ? T(worst + T(1)) : worst;
}

/// The rotation nearest to `R` (its polar factor), by Newton-Schulz steps `R <- R (3 - R^T R) / 2`. After n
/// steps an error `e = rotation_error(R)` is at most `e^(2^n)` plus rounding; n is chosen such that 0.01
/// reaches the rounding error of `T` (3 for double). Errors above about 0.5 may not converge: such a matrix
/// is no rotation.
template <Scalar T>
[[nodiscard]] constexpr Rotation<T> normalised(Rotation<T> R) noexcept {
  for (int digits = 2; digits <= std::numeric_limits<RealOf<T>>::digits10; digits *= 2) {
    const T half(0.5);
    const T xx = half * (T(3) - dot(R.x, R.x));
    const T yy = half * (T(3) - dot(R.y, R.y));
    const T zz = half * (T(3) - dot(R.z, R.z));
    const T xy = -half * dot(R.x, R.y);
    const T yz = -half * dot(R.y, R.z);
    const T zx = -half * dot(R.z, R.x);
    R = {R * Xyz<T>{xx, xy, zx}, R * Xyz<T>{xy, yy, yz}, R * Xyz<T>{zx, yz, zz}};
  }
  return R;
}

/// The rotation by `|vector|` [rad] about `vector`: Rodrigues' formula. Accurate to a few units in the last
/// place for every length that `T` can represent, 0 included; a NaN or an infinity gives NaNs.
template <Real T>
[[nodiscard]] Rotation<T> exp_so3(const Xyz<T>& vector) noexcept {
  Xyz<T> phi = vector;
  if (!(dot(phi, phi) <= detail::far_around<T>())) [[unlikely]]
    phi = detail::within_a_turn(vector);
  const auto f = detail::exp_factors(phi);
  const Xyz<T> a = f.sine * phi;
  const Xyz<T> b = f.cosine * phi;
  const T one(1);
  return {{one - (b.y * phi.y + b.z * phi.z), b.x * phi.y + a.z, b.x * phi.z - a.y},
          {b.x * phi.y - a.z, one - (b.x * phi.x + b.z * phi.z), b.y * phi.z + a.x},
          {b.x * phi.z + a.y, b.y * phi.z - a.x, one - (b.x * phi.x + b.y * phi.y)}};
}

/// The shortest rotation vector of `R`: `|phi| <= pi`. Accurate near 0 and near pi, where it is computed from
/// the unit quaternion's largest component.
///
/// Branch: at exactly half a turn both `phi` and `-phi` are valid, and the one whose largest component is
/// positive is returned; next to it rounding decides. A controller that must not jump there passes its last
/// value as `near`.
template <Real T>
[[nodiscard]] Xyz<T> log_so3(const Rotation<T>& R) noexcept {
  return detail::shortest_rotation_vector(detail::unit_quaternion(R.x, R.y, R.z));
}

/// The rotation vector of `R` on the branch of `near`: of `phi` and `phi` minus one turn about the same axis,
/// the one closer to `near`; `|phi| <= 2 pi`. Continuous along every path of rotations that stays between 0
/// and one turn.
template <Real T>
[[nodiscard]] Xyz<T> log_so3(const Rotation<T>& R, const Xyz<T>& near) noexcept {
  return detail::nearer_rotation_vector(log_so3(R), near);
}

namespace detail {
/// A rotation vector, and its factor of `left_jacobian_inverse_so3`.
template <Real T>
struct LogFactors {
  Xyz<T> phi;
  T inverse;
};
template <Real T>
[[nodiscard]] SKINCTL_NOINLINE LogFactors<T> log_factors_beyond(const Rotation<T>& R,
                                                                const Xyz<T>& near) noexcept {
  const Xyz<T> phi = log_so3(R, near);
  return {phi, inverse_factor(phi)};
}
/// `log_so3(R, near)` and its factor, by polynomials of the half angle's squared tangent up to 0.5 rad.
template <Real T>
[[nodiscard]] SKINCTL_INLINE LogFactors<T> log_factors(const Rotation<T>& R, const Xyz<T>& near) noexcept {
  if constexpr (math::detail::has_kernel<T>) {
    using Table = SmallTurn<T>;
    const Xyz<T> odd{R.y.z - R.z.y, R.z.x - R.x.z, R.x.y - R.y.x};
    const T w = T(1) + (R.x.x + R.y.y + R.z.z), per_w = T(1) / (w > T(1) ? w : T(1));
    const T u = dot(odd, odd) * (per_w * per_w);
    // w is 4 cos(a/2)^2. With `near` that small the other branch is never closer.
    if (u <= T(Table::limit) && w > T(1) && dot(near, near) < T(4)) [[likely]] {
      const T scale = (T(2) * per_w) * math::detail::polynomial(u, Table::atan);
      return {scale * odd, math::detail::polynomial(u, Table::bend)};
    }
  }
  return log_factors_beyond(R, near);
}
}  // namespace detail

/// `omega = J_l(phi) dphi`: the angular velocity, in the axes of the outer frame, of `R = exp_so3(phi)`.
template <Real T>
[[nodiscard]] Xyz<T> left_jacobian_so3(const Xyz<T>& phi, const Xyz<T>& dphi) noexcept {
  if (!(dot(phi, phi) <= detail::far_around<T>())) [[unlikely]]
    return detail::left_jacobian_far_around(phi, dphi);
  const Xyz<T> once = cross(phi, dphi);
  return dphi + detail::exp_factors(phi).cosine * once + detail::cubic_factor(phi) * cross(phi, once);
}

namespace detail {
/// `left_jacobian_inverse_so3` with its factor given.
template <Real T>
[[nodiscard]] SKINCTL_INLINE Xyz<T> left_jacobian_inverse(const Xyz<T>& phi, const T& factor,
                                                          const Xyz<T>& omega) noexcept {
  const Xyz<T> once = cross(phi, omega);
  return omega - T(0.5) * once + factor * cross(phi, once);
}
}  // namespace detail

/// `dphi = J_l(phi)^-1 omega`, for `|phi| < 2 pi`. At 2 pi it is singular (it grows as `1 / (2 pi - |phi|)`);
/// at pi its norm is pi / 2.
template <Real T>
[[nodiscard]] Xyz<T> left_jacobian_inverse_so3(const Xyz<T>& phi, const Xyz<T>& omega) noexcept {
  return detail::left_jacobian_inverse(phi, detail::inverse_factor(phi), omega);
}

SKINCTL_END_NAMESPACE
