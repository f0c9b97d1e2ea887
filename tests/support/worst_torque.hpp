// How far inverse dynamics of a model are from KDL's and MuJoCo's of the same bodies.
#pragma once

#include <algorithm>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

namespace skinctl::testing {

/// How many states the comparisons of whole robots take.
inline constexpr int many_states = SKINCTL_MANY_DIGITS ? 10000 : 100;

/// The worst of `count` random states, relative to the largest torque; infinite if one is not a number.
template <class M>
double worst_torque(const M& model, const oracle::Robot& bodies, int count, std::uint64_t seed) {
  constexpr std::size_t N = M::joints;
  oracle::KdlOracle kdl(bodies);
  oracle::MujocoOracle mujoco(bodies);
  oracle::Random random(seed);
  double worst = 0;
  const auto note = [&](const JointTorque<N>& tau, const double(&expected)[N]) {
    double error = 0, scale = 0;
    for (std::size_t i = 0; i < N; ++i) {
      if (!(std::abs(tau[i] - expected[i]) <= error)) error = std::abs(tau[i] - expected[i]);
      scale = std::max(scale, std::abs(expected[i]));
    }
    worst = std::max(worst, error == error ? error / scale : std::numeric_limits<double>::infinity());
  };
  for (int k = 0; k < count; ++k) {
    const Motion<N> at(random);
    const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
    double expected[N];
    kdl.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    note(tau, expected);
    mujoco.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    note(tau, expected);
  }
  return worst;
}

}  // namespace skinctl::testing
