// SPDX-License-Identifier: BSD-3-Clause
// Measures of an orientation error: on SO(3), in ZYZ angles.
#pragma once

#include "skinctl/kinematics/zyz.hpp"
#include "skinctl/trajectory/pose_spline.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The orientation's part, three coordinates, of the errors in eqs. (20), (21): see `SurfaceErrors`.
template <Real T = double>
struct OrientationErrors {
  Xyz<T> e, de, slope, v_d, a_d;
  Xyz<T> branch;  ///< branch for the next call: error, or the tool's ZYZ angles [rad]
};

namespace detail {
template <Real T>
constexpr Xyz<T> as_triple(const Zyz<T>& a) noexcept {
  return {a.phi, a.theta, a.psi};
}
template <Real T>
constexpr Zyz<T> as_zyz(const Xyz<T>& a) noexcept {
  return {a.x, a.y, a.z};
}
}  // namespace detail

/// The default measure of an orientation error: the rotation vector `phi` [rad] of `R R_d^T`, from the
/// target's axes to the tool's, along the axes of the base. `S` reads omega, and
/// `dphi = J_l^-1(phi) (omega - R R_d^T omega_d)`. A reset takes the shortest rotation; the branch is then
/// kept across half a turn. Regular up to one whole turn.
struct RotationVectorError {
  template <Real T>
  struct Map {
    [[nodiscard]] const Xyz<T>& omega(const Xyz<T>& v) const noexcept { return v; }
    [[nodiscard]] const Xyz<T>& domega(const Xyz<T>&, const Xyz<T>& a) const noexcept { return a; }
  };
  template <Real T>
  [[nodiscard]] static Map<T> map(const Rotation<T>&, const Xyz<T>&, const Xyz<T>&) noexcept {
    return {};
  }
  template <Real T>
  [[nodiscard]] static SKINCTL_INLINE OrientationErrors<T> errors(const Rotation<T>& R, const Xyz<T>& omega,
                                                                  const RotationReference<T>& target,
                                                                  const Xyz<T>& branch) noexcept {
    const Rotation<T> E = R * target.R.transpose();
    const auto [phi, factor] = detail::log_factors(E, branch);
    const Xyz<T> slope = detail::left_jacobian_inverse(phi, factor, Xyz<T>(omega - E * target.omega));
    return {phi, omega - target.omega, slope, target.omega, target.domega, phi};
  }
};

/// The paper's measure of an orientation error: differences of ZYZ angles, wrapped, and their rates, eqs.
/// (16), (17). At theta = 0 and pi one direction of rotation has no rate; this law does not turn the tool in
/// it.
struct ZyzError {
  template <Real T>
  struct Map {
    ZyzMap<T> B;
    Zyz<T> rates;
    [[nodiscard]] Xyz<T> omega(const Xyz<T>& v) const noexcept { return B * detail::as_zyz(v); }
    [[nodiscard]] Xyz<T> domega(const Xyz<T>& v, const Xyz<T>& a) const noexcept {
      return B * detail::as_zyz(a) + B.rate_times(rates, detail::as_zyz(v));
    }
  };
  template <Real T>
  [[nodiscard]] static Map<T> map(const Rotation<T>& R, const Xyz<T>& omega, const Xyz<T>& branch) noexcept {
    const ZyzMap<T> B(zyz_angles(R, detail::as_zyz(branch)));
    return {B, B.solve(omega)};
  }
  template <Real T>
  [[nodiscard]] static OrientationErrors<T> errors(const Rotation<T>& R, const Xyz<T>& omega,
                                                   const RotationReference<T>& target,
                                                   const Xyz<T>& branch) noexcept {
    const Zyz<T> is = zyz_angles(R, detail::as_zyz(branch));
    const Zyz<T> should = zyz_angles(target.R, is);
    const ZyzMap<T> B_d(should);
    const Zyz<T> v_d = B_d.solve(target.omega);
    const Xyz<T> rates = detail::as_triple(ZyzMap<T>(is).solve(omega));
    const Xyz<T> de = rates - detail::as_triple(v_d);
    return {detail::as_triple(difference(is, should)),
            de,
            de,
            detail::as_triple(v_d),
            detail::as_triple(B_d.solve_rate(target.omega, target.domega, v_d)),
            detail::as_triple(is)};
  }
};

SKINCTL_END_NAMESPACE
