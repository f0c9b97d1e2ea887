// SPDX-License-Identifier: BSD-3-Clause
// ZYZ angles of an orientation, their rates, and the analytic Jacobian.
#pragma once

#include <bit>
#include <cmath>

#include "skinctl/core/lane.hpp"
#include "skinctl/kinematics/jacobian_rate.hpp"
#include "skinctl/math/sincos.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The angles [rad] of `R = Rz(phi) Ry(theta) Rz(psi)`, or their rates [rad/s, rad/s^2].
template <Scalar T = double>
struct Zyz {
  T phi{0}, theta{0}, psi{0};

  friend SKINCTL_INLINE constexpr Zyz operator+(const Zyz& a, const Zyz& b) noexcept {
    return {a.phi + b.phi, a.theta + b.theta, a.psi + b.psi};
  }
  friend SKINCTL_INLINE constexpr Zyz operator*(const T& s, const Zyz& a) noexcept {
    return {s * a.phi, s * a.theta, s * a.psi};
  }
};

/// The rotation `Rz(phi) Ry(theta) Rz(psi)`.
template <Scalar T>
[[nodiscard]] Rotation<T> rotation_zyz(const Zyz<T>& angles) noexcept {
  const auto [sf, cf] = math::sincos(angles.phi);
  const auto [st, ct] = math::sincos(angles.theta);
  const auto [sp, cp] = math::sincos(angles.psi);
  return {{cf * ct * cp - sf * sp, sf * ct * cp + cf * sp, -st * cp},
          {-(cf * ct * sp) - sf * cp, cf * cp - sf * ct * sp, st * sp},
          {cf * st, sf * st, ct}};
}

/// The angle of the same direction in [-pi, pi] (pi as `T` rounds it), accurate to a unit in the last place
/// of pi for any finite angle; one that lies there already is returned as it is. NaN for an infinity.
template <Real T>
[[nodiscard]] T wrapped(const T& angle) noexcept {
  using std::atan2, std::cos, std::sin;
  const T half_turn = atan2(T(0), T(-1));
  if (angle >= -half_turn && angle <= half_turn) return angle;
  return atan2(T(sin(angle)), T(cos(angle)));
}
/// The difference `a - b`, each angle wrapped to the shortest one.
template <Real T>
[[nodiscard]] Zyz<T> difference(const Zyz<T>& a, const Zyz<T>& b) noexcept {
  return {wrapped(T(a.phi - b.phi)), wrapped(T(a.theta - b.theta)), wrapped(T(a.psi - b.psi))};
}

namespace detail {
/// The angles with the given `phi` and `theta`; psi from R rotated back by phi.
template <Real T>
Zyz<T> zyz_with(const Rotation<T>& R, const T& phi, const T& theta) noexcept {
  using std::atan2, std::cos, std::sin;
  const T s = sin(phi), c = cos(phi);
  return {phi, theta, atan2(T(c * R.x.y - s * R.x.x), T(c * R.y.y - s * R.y.x))};
}
}  // namespace detail

/// ZYZ angles of a rotation: `phi` and `psi` in [-pi, pi], `theta` in [0, pi].
///
/// At theta = 0 and pi only phi + psi (phi - psi) is determined: phi is 0 there, and psi is that angle. Near
/// them the error of phi is rounding / sin(theta); psi is computed from R rotated back by phi, so that
/// `rotation_zyz(zyz_angles(R))` is R to a few units in the last place everywhere. A NaN gives NaNs.
template <Real T>
[[nodiscard]] Zyz<T> zyz_angles(const Rotation<T>& R) noexcept {
  using std::atan2, std::sqrt;
  const T s = sqrt(T(R.z.x * R.z.x + R.z.y * R.z.y));
  return detail::zyz_with(R, s == T(0) ? T(0) : T(atan2(R.z.y, R.z.x)), T(atan2(s, R.z.z)));
}
/// ZYZ angles for a controller that must not jump: of the two triples that give R (theta positive or
/// negative) the one whose phi is nearer to `near.phi`, and `near.phi` itself where R does not determine phi.
/// A path straight through theta = 0 or pi stays continuous.
template <Real T>
[[nodiscard]] Zyz<T> zyz_angles(const Rotation<T>& R, const Zyz<T>& near) noexcept {
  using std::atan2, std::sqrt;
  const T half_turn = atan2(T(0), T(-1));
  const T s = sqrt(T(R.z.x * R.z.x + R.z.y * R.z.y));
  if (s == T(0)) return detail::zyz_with(R, wrapped(near.phi), T(atan2(s, R.z.z)));
  const T phi = atan2(R.z.y, R.z.x);
  const T away = wrapped(T(phi - near.phi));
  if (away >= T(-0.5) * half_turn && away <= T(0.5) * half_turn)
    return detail::zyz_with(R, phi, T(atan2(s, R.z.z)));
  return detail::zyz_with(R, wrapped(T(phi + half_turn)), T(-atan2(s, R.z.z)));
}

/// The map B from rates of ZYZ angles to angular velocity along the axes of the outer frame, eq. (17):
///
///     omega = B [dphi dtheta dpsi]',   columns z, Rz(phi) y, Rz(phi) Ry(theta) z,   |det B| = |sin theta|
///
/// With the tool straight up or down B has no inverse: no rates give an angular velocity about the axis
/// perpendicular to z and to `Rz(phi) y`. Within `|sin theta| < zone` the inverse is therefore damped:
/// `1 / s` becomes
///
///     s / (s^2 + l^2),   l^2 = (zone / 2)^2 (1 - (s / zone)^2)^2.
///
/// That component of omega is then reduced, to zero at theta = 0 and pi; the others stay exact. The rates are
/// at most `2 / zone` times omega, and continuous.
template <Scalar T = double>
class ZyzMap {
 public:
  /// @param zone  sine of the angle from the vertical below which the inverse is damped, in (0, 1).
  SKINCTL_INLINE explicit ZyzMap(const Zyz<T>& angles, const T& zone = static_cast<T>(0.05)) noexcept {
    const auto [sf, cf] = math::sincos(angles.phi);
    const auto [st, ct] = math::sincos(angles.theta);
    sin_phi_ = sf, cos_phi_ = cf, sin_theta_ = st, cos_theta_ = ct;
    const T r = T(1) - st * st / (zone * zone);
    const auto inside = r > T(0);
    const T l2 = select(inside, T(T(0.25) * zone * zone * r * r), T(0));
    const T dl2 = select(inside, T(-(r * st)), T(0));  // d(l^2)/ds
    const T d = st * st + l2;
    inverse_ = st / d;
    slope_ = (d - st * (T(2) * st + dl2)) / (d * d);
  }

  /// The angular velocity `B rates`, along the axes of the outer frame [rad/s].
  [[nodiscard]] SKINCTL_INLINE Xyz<T> operator*(const Zyz<T>& rates) const noexcept {
    const T across = sin_theta_ * rates.psi;
    return {cos_phi_ * across - sin_phi_ * rates.theta, sin_phi_ * across + cos_phi_ * rates.theta,
            rates.phi + cos_theta_ * rates.psi};
  }
  /// `dB rates`, while the angles change at `rates`: the angular acceleration at constant rates [rad/s^2].
  [[nodiscard]] SKINCTL_INLINE Xyz<T> rate_times(const Zyz<T>& rates) const noexcept {
    const T across = sin_theta_ * rates.psi;
    const T x = cos_theta_ * rates.theta * rates.psi - rates.phi * rates.theta;
    const T y = rates.phi * across;
    return {cos_phi_ * x - sin_phi_ * y, sin_phi_ * x + cos_phi_ * y, -(rates.theta * across)};
  }
  /// `dB c` for numbers `c` other than the rates at which the angles change.
  [[nodiscard]] SKINCTL_INLINE Xyz<T> rate_times(const Zyz<T>& rates, const Zyz<T>& c) const noexcept {
    const T along = c.psi * rates.theta * cos_theta_ - c.theta * rates.phi;
    const T across = c.psi * rates.phi * sin_theta_;
    return {cos_phi_ * along - sin_phi_ * across, sin_phi_ * along + cos_phi_ * across,
            -(c.psi * rates.theta * sin_theta_)};
  }
  /// The rates of the angles `B^-1 omega`, damped near the singularity [rad/s].
  [[nodiscard]] SKINCTL_INLINE Zyz<T> solve(const Xyz<T>& omega) const noexcept {
    const T psi = inverse_ * (cos_phi_ * omega.x + sin_phi_ * omega.y);
    return {omega.z - cos_theta_ * psi, cos_phi_ * omega.y - sin_phi_ * omega.x, psi};
  }
  /// The time derivative of `solve(omega)`: `B^-1 domega + d(B^-1) omega`, damping included, while the angles
  /// of this map change at `rates`.
  [[nodiscard]] SKINCTL_INLINE Zyz<T> solve_rate(const Xyz<T>& omega, const Xyz<T>& domega,
                                                 const Zyz<T>& rates) const noexcept {
    const T x = cos_phi_ * omega.x + sin_phi_ * omega.y;
    const T y = cos_phi_ * omega.y - sin_phi_ * omega.x;
    const T dx = cos_phi_ * domega.x + sin_phi_ * domega.y + rates.phi * y;
    const T dy = cos_phi_ * domega.y - sin_phi_ * domega.x - rates.phi * x;
    const T psi = inverse_ * x;
    const T dpsi = inverse_ * dx + slope_ * cos_theta_ * rates.theta * x;
    return {domega.z - cos_theta_ * dpsi + sin_theta_ * rates.theta * psi, dy, dpsi};
  }
  /// The determinant of B: `det B = -sin theta`.
  [[nodiscard]] SKINCTL_INLINE T determinant() const noexcept { return -sin_theta_; }

 private:
  T sin_phi_, cos_phi_, sin_theta_, cos_theta_;
  T inverse_;  // 1 / sin theta, damped
  T slope_;    // its derivative by sin theta
};

/// Motion of a frame in ZYZ coordinates: the velocity of its origin and the rates of its angles (or, as
/// second derivatives, their accelerations).
template <Scalar T = double>
struct ZyzVelocity {
  Xyz<T> linear{T(0), T(0), T(0)};  ///< velocity [m/s] or acceleration [m/s^2] of the origin in the base
  Zyz<T> angles;                    ///< rates [rad/s] or accelerations [rad/s^2] of the angles
};

/// The analytic Jacobian `[1 0; 0 B^-1] J` of eqs. (16)-(17): from joint velocities to the velocity of the
/// origin and the rates of the ZYZ angles. Applied, not stored: `times(dq)` costs two products with sparse
/// factors. Near theta = 0 and pi see `ZyzMap`.
template <class J>
class AnalyticJacobian {
 public:
  using T = typename J::scalar;
  static constexpr std::size_t joints = J::joints;

  /// @param geometric  the frame's Jacobian along the axes of the base; must outlive this object.
  /// @param angles     the frame's ZYZ angles in the base.
  SKINCTL_INLINE AnalyticJacobian(const J& geometric, const Zyz<T>& angles) noexcept
      : geometric_(geometric), map_(angles) {}

  [[nodiscard]] SKINCTL_INLINE ZyzVelocity<T> operator*(const JointVelocity<joints, T>& dq) const noexcept {
    const auto V = geometric_ * dq;
    return {V.linear, map_.solve(V.angular)};
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // an analytic Jacobian takes joint velocities
  // clang-format on

  /// `J_a ddq + dJ_a dq`: the second derivatives of position and angles.
  [[nodiscard]] SKINCTL_INLINE ZyzVelocity<T> acceleration(
      const JointVelocity<joints, T>& dq, const JointAcceleration<joints, T>& ddq) const noexcept {
    const auto V = geometric_ * dq;
    const auto a = skinctl::acceleration(geometric_, dq, ddq);
    return {a.linear, map_.solve_rate(V.angular, a.angular, map_.solve(V.angular))};
  }
  /// Column of joint `Ix` as `ZyzVelocity` per joint unit.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE ZyzVelocity<T> column() const noexcept {
    const auto& c = geometric_.template column<Ix>();
    return {c.linear, map_.solve(c.angular)};
  }
  /// Column of joint `Ix` of `dJ_a`, while the joints move at `dq`.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE ZyzVelocity<T> column_rate(const JacobianRate<J>& dJ,
                                                          const JointVelocity<joints, T>& dq) const noexcept {
    const auto& c = dJ.template column<Ix>();
    const Zyz<T> rates = map_.solve((geometric_ * dq).angular);
    return {c.linear, map_.solve_rate(geometric_.template column<Ix>().angular, c.angular, rates)};
  }

 private:
  const J& geometric_;
  ZyzMap<T> map_;
};

SKINCTL_END_NAMESPACE
