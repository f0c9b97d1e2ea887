// SPDX-License-Identifier: BSD-3-Clause
// Joint torques from motion: inverse dynamics, the bias C dq + G, and the regressor product Y_r Theta.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"
#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Joint torques `M(q) ddq + C(q, dq) dq + G(q)` [N m], by one recursion from the base to the tips and back.
///
/// For any tree. Relative to the largest torque that occurs, the error is a few units in the last place times
/// the number of joints; no branch, so the cost does not depend on the state. A NaN in any input gives NaN
/// torques. Of a UR5 within 5.7e-13 N m (float: 3.2e-4) of the exact ones at every position and with rates
/// within 3 rad/s and 3 rad/s^2 (proven, `bench/studies/bounds`; found: 1.2e-13, 5.4e-5).
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> inverse_dynamics(
    const M& model, const JointAngles<M, T, Mask>& angles, const JointVelocity<M::joints, T>& dq,
    const JointAcceleration<M::joints, T>& ddq) noexcept {
  JointTorque<M::joints, T> tau;
  const detail::Values<T> v{dq.data};
  detail::run_recursion<T>(model, angles, v, v, detail::Values<T>{ddq.data}, -model.template gravity<T>(),
                           tau.data);
  return tau;
}
template <RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> inverse_dynamics(
    const M& model, const JointPosition<M::joints, T>& q, const JointVelocity<M::joints, T>& dq,
    const JointAcceleration<M::joints, T>& ddq) noexcept {
  return inverse_dynamics(model, JointAngles<M, T>(model, q), dq, ddq);
}
// clang-format off
template <RobotModel M, Scalar T> requires(!computes_in<M, T>)
void inverse_dynamics(const M&, const JointPosition<M::joints, T>&, const JointVelocity<M::joints, T>&, const JointAcceleration<M::joints, T>&) = delete;  // the model computes in another scalar: calibrated_from<Description, float>, or q.cast<double>()
template <RobotModel M, class... Q, std::enable_if_t<any_eigen<Q...>, int> = 0>
void inverse_dynamics(const M&, const Q&...) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
// clang-format on

/// The bias `C(q, dq) dq + G(q)` [N m]: inverse dynamics at zero acceleration.
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> bias_torque(
    const M& model, const JointAngles<M, T, Mask>& angles, const JointVelocity<M::joints, T>& dq) noexcept {
  JointTorque<M::joints, T> tau;
  const detail::Values<T> v{dq.data};
  detail::run_recursion<T>(model, angles, v, v, detail::NoValues{}, -model.template gravity<T>(), tau.data);
  return tau;
}

/// Coriolis and centrifugal torques `C(q, dq) dq` [N m], without gravity.
template <RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> coriolis_torque(
    const M& model, const JointAngles<M, T, Mask>& angles, const JointVelocity<M::joints, T>& dq) noexcept {
  JointTorque<M::joints, T> tau;
  const detail::Values<T> v{dq.data};
  detail::run_recursion<T>(model, angles, v, v, detail::NoValues{}, ZeroTriple{}, tau.data);
  return tau;
}

/// `Y_r Theta = M(q) ddq_r + C(q, dq) dq_r [+ G(q)]` of eq. (8) [N m], with Christoffel's C: `dM/dt - 2C` is
/// skew-symmetric, on which the passivity of the sliding-mode laws depends. One recursion at the cost of
/// inverse dynamics; of a UR5, at rates within 3, within 5.8e-13 N m (float: 3.2e-4; proven).
template <GravityTerm Gravity = GravityTerm::included, RobotModel M, Scalar T, LinkMask Mask>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> yr_theta(
    const M& model, const JointAngles<M, T, Mask>& angles, const JointVelocity<M::joints, T>& dq,
    const JointVelocity<M::joints, T>& dq_r, const JointAcceleration<M::joints, T>& ddq_r) noexcept {
  JointTorque<M::joints, T> tau;
  const detail::Values<T> v{dq.data};
  const detail::Values<T> r{dq_r.data};
  const detail::Values<T> a{ddq_r.data};
  if constexpr (Gravity == GravityTerm::included) {
    detail::run_recursion<T>(model, angles, v, r, a, -model.template gravity<T>(), tau.data);
  } else {
    detail::run_recursion<T>(model, angles, v, r, a, ZeroTriple{}, tau.data);
  }
  return tau;
}
template <GravityTerm Gravity = GravityTerm::included, RobotModel M, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointTorque<M::joints, T> yr_theta(
    const M& model, const JointPosition<M::joints, T>& q, const JointVelocity<M::joints, T>& dq,
    const JointVelocity<M::joints, T>& dq_r, const JointAcceleration<M::joints, T>& ddq_r) noexcept {
  return yr_theta<Gravity>(model, JointAngles<M, T>(model, q), dq, dq_r, ddq_r);
}

SKINCTL_END_NAMESPACE
