// SPDX-License-Identifier: BSD-3-Clause
// Splines of rotations: one turn about a fixed axis, along a quintic.
#pragma once

#include "skinctl/frames/rotation.hpp"
#include "skinctl/trajectory/quintic.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An orientation with angular velocity and acceleration, in the axes of the frame in which the rotations are
/// given.
template <Real T = double>
struct RotationReference {
  Rotation<T> R;
  Xyz<T> omega;   ///< angular velocity, along the outer frame's axes [rad/s]
  Xyz<T> domega;  ///< angular acceleration, along the outer frame's axes [rad/s^2]
};

/// A spline of rotations from `R_i` to `R_g` by the shortest turn: `R = exp(a1 phi) R_i` with the rotation
/// vector `phi = log(R_g R_i^T)`, so that `omega = a2 phi` and `domega = a3 phi`. At rest at both ends.
template <Real T = double>
class RotationSpline {
 public:
  /// A spline at rest in the identity.
  RotationSpline() noexcept : phi_{T(0), T(0), T(0)}, tf_(T(0)) {}
  /// @param R_i, R_g  start and goal, rotations to within `tolerance<T>`, of one frame in another.
  /// @param tf        duration [s]; if not positive, the reference is `R_g` from the start.
  RotationSpline(const Rotation<T>& R_i, const Rotation<T>& R_g, const T& tf) noexcept
      : R_i_(R_i), R_g_(R_g), phi_(log_so3(R_g * R_i.transpose())), tf_(tf) {}

  /// The spline on the branch of `near`: within rounding of half a turn both directions are shortest, and a
  /// goal that moves there would make the spline reverse. Pass the last spline's `turn()`.
  RotationSpline(const Rotation<T>& R_i, const Rotation<T>& R_g, const T& tf, const Xyz<T>& near) noexcept
      : R_i_(R_i), R_g_(R_g), phi_(log_so3(R_g * R_i.transpose(), near)), tf_(tf) {}

  /// This spline with a start in motion: the parts of `omega` and `domega` along its turn, see `MovingStart`.
  [[nodiscard]] RotationSpline from(const Xyz<T>& omega, const Xyz<T>& domega) const noexcept {
    RotationSpline next = *this;
    const T square = dot(phi_, phi_);
    if (square > T(0)) next.start_ = MovingStart<T>::along(square, dot(omega, phi_), dot(domega, phi_), tf_);
    return next;
  }

  /// The reference `t` seconds after the start; exactly `R_i` before it and `R_g` from the end on.
  [[nodiscard]] RotationReference<T> at(const T& t) const noexcept {
    const T rate = tf_ > T(0) ? T(T(1) / tf_) : T(0);
    auto way = quintic(tf_ > T(0) ? T(t / tf_) : T(1), rate);
    if (start_.rate > T(0) && t < tf_) [[unlikely]]
      way = way + start_.at(T(t / tf_), tf_);
    const Xyz<T> omega = way.a2 * phi_, domega = way.a3 * phi_;
    if (way.rest == T(0)) return {R_g_, omega, domega};
    if (way.a1 == T(0)) return {R_i_, omega, domega};
    const bool early = way.a1 <= T(0.5);  // from the nearer end, by half of the turn at most
    return {exp_so3(Xyz<T>((early ? way.a1 : T(-way.rest)) * phi_)) * (early ? R_i_ : R_g_), omega, domega};
  }
  /// The whole turn as a rotation vector [rad].
  [[nodiscard]] const Xyz<T>& turn() const noexcept { return phi_; }

 private:
  Rotation<T> R_i_, R_g_;
  Xyz<T> phi_;
  T tf_;
  MovingStart<T> start_;
};

SKINCTL_END_NAMESPACE
