// The classical fourth-order step of a virtual robot's velocity.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"
#include "skinctl/robot/virtual_mass.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Largest number of parts of a sub-step.
inline constexpr int most_runge_kutta_parts = 8;

/// `M_v dv/dt = tau - C v - G - B v + M_v pull` for the joints of `S`, with the `G` of the gravity law if there
/// is one; false if a mass matrix could not be factorised. `a` holds the accelerations of the other joints, and
/// receives those of `S`. `friction`, if not null, receives an upper bound of the fastest rate at which friction
/// stops a joint [1/s], the trace of `M_v^-1 B`.
template <class S, class K, Real T>
[[nodiscard]] SKINCTL_NOINLINE bool virtual_acceleration(
    const K& known, const VirtualDynamics<S::count, T>& shape, const JointPosition<K::joints, T>& q,
    const JointVelocity<K::joints, T>& v, const JointTorque<S::count, T>& tau,
    const JointAcceleration<S::count, T>& pull, JointAcceleration<K::joints, T>& a, T* friction) noexcept {
  constexpr std::size_t n = S::count;
  const JointAngles<typename K::model_type, T> angles(known.model(), q);
  const MassMatrix<K::joints, T> whole = mass_matrix(known.model(), angles);
  MassMatrix<n, T> m = block_of<S>(whole);
  JointTorque<K::joints, T> bias;
  if constexpr (K::needs.gravity) {
    bias = coriolis_torque(known.model(), angles, v) + known.gravity();
  } else {
    bias = bias_torque(known.model(), angles, v);
  }
  JointTorque<n, T> net;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t I = S::index[i];
    m(i, i) = m(i, i) + shape.inertia[i];
    net[i] = tau[i] - bias[I] - shape.viscous[i] * v[I];
    if constexpr (!S::is_all)
      for (const std::size_t j : S::Others::index) net[i] = net[i] - whole(I, j) * a[j];
  }
  const math::Ldlt<n, T> factors(m.data);
  if (!factors.positive_definite()) return false;
  JointAcceleration<n, T> own;
  factors.solve(net.data, own.data);
  for (std::size_t i = 0; i < n; ++i) own[i] = own[i] + pull[i] - shape.damping * v[S::index[i]];
  S::put(own, a);
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
/// constants: the method is stable up to 2.78). `driven`, if not null, holds the accelerations of the joints
/// that are not in `S`. False, with `v` unchanged, if that is too many parts.
template <class S, class K, Real T>
[[nodiscard]] bool runge_kutta(const K& known, const VirtualDynamics<S::count, T>& shape,
                               const JointTorque<S::count, T>& tau,
                               const JointAcceleration<S::count, T>& pull,
                               const JointAcceleration<K::joints, T>* driven,
                               JointVelocity<S::count, T>& v) noexcept {
  constexpr std::size_t n = K::joints;
  JointPosition<n, T> q = known.q();
  JointVelocity<n, T> u = known.dq();
  JointAcceleration<n, T> a1;
  if (driven != nullptr) a1 = *driven;
  JointAcceleration<n, T> a2 = a1, a3 = a1, a4 = a1;
  T friction(0);
  const auto at = [&](const JointPosition<n, T>& here, const JointVelocity<n, T>& moving,
                      JointAcceleration<n, T>& a, T* rate = nullptr) {
    return virtual_acceleration<S, K, T>(known, shape, here, moving, tau, pull, a, rate);
  };
  if (!at(q, u, a1, &friction)) return false;
  int parts = 1;
  while (parts <= most_runge_kutta_parts && !(known.dt() * friction <= T(2 * parts))) ++parts;
  if (parts > most_runge_kutta_parts) return false;
  const T h = known.dt() / T(parts), half = T(0.5) * h;
  for (int k = 0; k < parts; ++k) {
    if (k > 0 && !at(q, u, a1)) return false;
    const auto u2 = integrate(u, a1, half);
    if (!at(integrate(q, u, half), u2, a2)) return false;
    const auto u3 = integrate(u, a2, half);
    if (!at(integrate(q, u2, half), u3, a3)) return false;
    const auto u4 = integrate(u, a3, h);
    if (!at(integrate(q, u3, h), u4, a4)) return false;
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = q[i] + h / T(6) * (u[i] + T(2) * u2[i] + T(2) * u3[i] + u4[i]);
      u[i] = u[i] + h / T(6) * (a1[i] + T(2) * a2[i] + T(2) * a3[i] + a4[i]);
    }
  }
  v = S::of(u);
  return true;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
