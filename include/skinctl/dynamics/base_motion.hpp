// SPDX-License-Identifier: BSD-3-Clause
// Dynamics of a robot whose base moves.
#pragma once

#include "skinctl/dynamics/inverse_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motion of a base with which a recursion of dynamics begins: relative to an inertial world, of the
/// origin of Base, along the axes of Base. Its linear velocity does not matter.
template <Scalar T = double>
struct BaseMotion {
  Xyz<T> angular{T(0), T(0), T(0)};  ///< angular velocity omega [rad/s]
  Xyz<T> turning{T(0), T(0), T(0)};  ///< angular acceleration alpha [rad/s^2]
  Xyz<T> linear{T(0), T(0), T(0)};   ///< acceleration less that of free fall, `A_WB - g` [m/s^2]
  friend bool operator==(const BaseMotion&, const BaseMotion&) noexcept = default;
};

/// A model with the motion of its base in this cycle: a scene passes it to its touch.
template <RobotModel M, Scalar T>
struct ModelOnBase : M {
  BaseMotion<T> base_motion;
};
namespace detail {
template <class M>
inline constexpr bool knows_base_motion = false;
template <class M, class T>
inline constexpr bool knows_base_motion<ModelOnBase<M, T>> = true;
}  // namespace detail

/// The motion of a base that stands as `model` says.
template <Scalar T, RobotModel M>
[[nodiscard]] BaseMotion<T> base_at_rest(const M& model) noexcept {
  return {.linear = -dense<T>(model.template gravity<T>())};
}
/// The acceleration of a point that is fixed to Base at `p`, less that of free fall [m/s^2].
template <Scalar T>
[[nodiscard]] Xyz<T> acceleration_at(const BaseMotion<T>& base, const Xyz<T>& p) noexcept {
  return base.linear + cross(base.turning, p) + cross(base.angular, cross(base.angular, p));
}

/// Joint torques `M ddq + C dq + G` [N m] of a robot whose base moves as `base` says: by the recursion that
/// begins with it; the gravity of `model` is not read. NaN in gives NaN.
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> inverse_dynamics_on(
    const M& model, const JointAngles<M, T, Mask>& angles, const JointVelocity<M::joints, T>& dq,
    const JointAcceleration<M::joints, T>& ddq, const BaseMotion<T>& base) noexcept {
  JointTorque<M::joints, T> tau;
  const detail::Values<T> v{dq.data}, a{ddq.data};
  detail::run_recursion_from<T>(
      model, detail::ModelBodies<M>{model}, angles, v, v, a,
      detail::ReferenceMotion{base.angular, base.angular, base.turning, base.linear}, tau.data);
  return tau;
}

/// The torque that the motion `base` of its base adds to that which a robot needs [N m]: gravity along
/// another direction, the base's acceleration, centrifugal and Coriolis forces of its turning.
/// @param at_rest  the model with the gravity of a base that stands, which laws compensate.
template <RobotModel M, Scalar T>
[[nodiscard]] JointTorque<M::joints, T> base_torque(const M& at_rest, const JointPosition<M::joints, T>& q,
                                                    const JointVelocity<M::joints, T>& dq,
                                                    const BaseMotion<T>& base) noexcept {
  const JointAngles<M, T> angles(at_rest, q);
  return inverse_dynamics_on(at_rest, angles, dq, JointAcceleration<M::joints, T>{}, base) -
         bias_torque(at_rest, angles, dq);
}

SKINCTL_END_NAMESPACE
