// The classical fourth-order step of a virtual robot's velocity.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Largest number of parts of a sub-step.
inline constexpr int most_runge_kutta_parts = 8;

/// `M_v dv/dt = tau - C v - G - B v + M_v pull`, with the `G` of the gravity law if there is one; false if a
/// mass matrix could not be factorised. `friction`, if not null, receives an upper bound of the fastest rate
/// at which friction stops a joint [1/s], the trace of `M_v^-1 B`.
template <class K, Real T>
[[nodiscard]] SKINCTL_NOINLINE bool virtual_acceleration(
    const K& known, const VirtualDynamics<K::joints, T>& shape, const JointPosition<K::joints, T>& q,
    const JointVelocity<K::joints, T>& v, const JointTorque<K::joints, T>& tau,
    const JointAcceleration<K::joints, T>& pull, JointAcceleration<K::joints, T>& a, T* friction) noexcept {
  constexpr std::size_t n = K::joints;
  const JointAngles<typename K::model_type, T> angles(known.model(), q);
  MassMatrix<n, T> m = mass_matrix(known.model(), angles);
  JointTorque<n, T> bias;
  if constexpr (K::needs.gravity) {
    bias = coriolis_torque(known.model(), angles, v) + known.gravity();
  } else {
    bias = bias_torque(known.model(), angles, v);
  }
  JointTorque<n, T> net;
  for (std::size_t i = 0; i < n; ++i) {
    m(i, i) = m(i, i) + shape.inertia[i];
    net[i] = tau[i] - bias[i] - shape.viscous[i] * v[i];
  }
  const math::Ldlt<n, T> factors(m.data);
  if (!factors.positive_definite()) return false;
  factors.solve(net.data, a.data);
  for (std::size_t i = 0; i < n; ++i) a[i] = a[i] + pull[i] - shape.damping * v[i];
  if (friction != nullptr) {
    *friction = shape.damping;
    for (std::size_t i = 0; i < n; ++i) {
      JointTorque<n, T> unit;
      JointAcceleration<n, T> column;
      unit[i] = T(1);
      factors.solve(unit.data, column.data);
      *friction = *friction + shape.viscous[i] * column[i];
    }
  }
  return true;
}

/// The velocity after `known.dt()` in as many equal parts as friction needs (each at most 2 of its time
/// constants: the method is stable up to 2.78). False, with `v` unchanged, if that is too many parts.
template <class K, Real T>
[[nodiscard]] bool runge_kutta(const K& known, const VirtualDynamics<K::joints, T>& shape,
                               const JointTorque<K::joints, T>& tau,
                               const JointAcceleration<K::joints, T>& pull,
                               JointVelocity<K::joints, T>& v) noexcept {
  constexpr std::size_t n = K::joints;
  JointPosition<n, T> q = known.q();
  JointVelocity<n, T> u = known.dq();
  JointAcceleration<n, T> a1, a2, a3, a4;
  T friction(0);
  if (!virtual_acceleration(known, shape, q, u, tau, pull, a1, &friction)) return false;
  int parts = 1;
  while (parts <= most_runge_kutta_parts && !(known.dt() * friction <= T(2 * parts))) ++parts;
  if (parts > most_runge_kutta_parts) return false;
  const T h = known.dt() / T(parts), half = T(0.5) * h;
  for (int k = 0; k < parts; ++k) {
    if (k > 0 && !virtual_acceleration<K, T>(known, shape, q, u, tau, pull, a1, nullptr)) return false;
    const auto u2 = integrate(u, a1, half);
    if (!virtual_acceleration<K, T>(known, shape, integrate(q, u, half), u2, tau, pull, a2, nullptr))
      return false;
    const auto u3 = integrate(u, a2, half);
    if (!virtual_acceleration<K, T>(known, shape, integrate(q, u2, half), u3, tau, pull, a3, nullptr))
      return false;
    const auto u4 = integrate(u, a3, h);
    if (!virtual_acceleration<K, T>(known, shape, integrate(q, u3, h), u4, tau, pull, a4, nullptr))
      return false;
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = q[i] + h / T(6) * (u[i] + T(2) * u2[i] + T(2) * u3[i] + u4[i]);
      u[i] = u[i] + h / T(6) * (a1[i] + T(2) * a2[i] + T(2) * a3[i] + a4[i]);
    }
  }
  v = u;
  return true;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
