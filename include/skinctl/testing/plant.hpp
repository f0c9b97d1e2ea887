// SPDX-License-Identifier: BSD-3-Clause
// The plant of the control tests: a robot with exactly the model's parameters, finely integrated under a held
// torque.
#pragma once

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// The acceleration under a torque of a robot whose motors add `rotors` [kg m^2] to its mass matrix.
template <class M, Real T>
JointAcceleration<M::joints, T> acceleration(const M& model, const State<M::joints, T>& x,
                                             const JointTorque<M::joints, T>& tau,
                                             const JointTorque<M::joints, T>& rotors) {
  auto mass = mass_matrix(model, x.q);
  for (std::size_t i = 0; i < M::joints; ++i) mass(i, i) += rotors[i];
  const auto drive = tau - inverse_dynamics(model, x.q, x.dq, JointAcceleration<M::joints, T>{});
  JointAcceleration<M::joints, T> out;
  math::Ldlt<M::joints, T>(mass.data).solve(drive.data, out.data);
  return out;
}

/// The state `dt` seconds later under a held torque: Runge-Kutta of fourth order in `steps` steps.
template <class M, Real T>
State<M::joints, T> simulate(const M& model, State<M::joints, T> x, const JointTorque<M::joints, T>& tau,
                             const T& dt, int steps = 4) {
  const T h = dt / T(steps);
  for (int k = 0; k < steps; ++k) {
    const auto a1 = forward_dynamics(model, x.q, x.dq, tau).acceleration;
    const auto v2 = integrate(x.dq, a1, T(h / T(2)));
    const auto a2 = forward_dynamics(model, integrate(x.q, x.dq, T(h / T(2))), v2, tau).acceleration;
    const auto v3 = integrate(x.dq, a2, T(h / T(2)));
    const auto a3 = forward_dynamics(model, integrate(x.q, v2, T(h / T(2))), v3, tau).acceleration;
    const auto v4 = integrate(x.dq, a3, h);
    const auto a4 = forward_dynamics(model, integrate(x.q, v3, h), v4, tau).acceleration;
    x.q = integrate(x.q, JointVelocity<M::joints, T>(T(1) / T(6) * (x.dq + T(2) * v2 + T(2) * v3 + v4)), h);
    x.dq =
        integrate(x.dq, JointAcceleration<M::joints, T>(T(1) / T(6) * (a1 + T(2) * a2 + T(2) * a3 + a4)), h);
  }
  x.time += nanoseconds(static_cast<double>(dt));
  return x;
}

}  // namespace skinctl::testing
