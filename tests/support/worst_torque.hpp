// How far inverse dynamics of a model are from KDL's and MuJoCo's of the same bodies.
#pragma once

#include <algorithm>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

namespace skinctl::test {

/// The worst of `count` random states, relative to the largest torque.
template <class M>
double worst_torque(const M& model, const oracle::Robot& bodies, int count, std::uint64_t seed) {
  constexpr std::size_t N = M::joints;
  oracle::KdlOracle kdl(bodies);
  oracle::MujocoOracle mujoco(bodies);
  oracle::Random random(seed);
  double worst = 0;
  for (int k = 0; k < count; ++k) {
    const Motion<N> at(random);
    const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
    double expected[N];
    kdl.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    worst = std::max(worst, relative_error(tau, expected, N));
    mujoco.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    worst = std::max(worst, relative_error(tau, expected, N));
  }
  return worst;
}

}  // namespace skinctl::test
