// What the tests of the oracles share: 50 digits, relative differences, the robots they are tried on.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/digits50.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robot_table.hpp"

namespace oracle {

using skinctl::testing::Digits50;
using Definition = EulerLagrange<Digits50>;

inline std::vector<Digits50> widened(const std::vector<double>& x) {
  return {x.begin(), x.end()};
}

/// Largest difference, relative to the largest entry of b: the error of a vector against its own scale.
template <class A, class B>
double difference(const A& a, const B& b) {
  double worst = 0, scale = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(Digits50(a[i]) - Digits50(b[i]))));
    scale = std::max(scale, std::abs(static_cast<double>(b[i])));
  }
  return scale > 0 ? worst / scale : worst;
}

struct NamedRobot {
  std::string name;
  Robot robot;
};

inline std::vector<NamedRobot> robots() {
  std::vector<NamedRobot> all{{"UR5", ur5()},
                              {"Allegro", allegro_right()},
                              {"Allegro without fixed bodies", without_fixed(allegro_right())}};
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    all.push_back({"chain of 7, seed " + std::to_string(seed), random_chain(seed, 7)});
    all.push_back({"tree of 14, seed " + std::to_string(seed), random_tree(seed, 14)});
  }
  all.push_back({"chain of 20", random_chain(4, 20)});
  all.push_back({"tree of 22", random_tree(5, 22)});
  return all;
}

/// States: ordinary ones, the zero pose, at rest, fast.
struct State {
  std::string name;
  std::vector<double> q, dq, ddq, dq_r;
};

inline std::vector<State> states(std::uint64_t seed, int n) {
  Random random(seed);
  std::vector<State> all;
  for (int i = 0; i < (n < 10 ? 3 : 1); ++i)
    all.push_back(
        {"ordinary", random.vector(n, 3), random.vector(n, 2), random.vector(n, 5), random.vector(n, 2)});
  all.push_back(
      {"zero pose", random.vector(n, 0), random.vector(n, 2), random.vector(n, 5), random.vector(n, 2)});
  all.push_back(
      {"at rest", random.vector(n, 3), random.vector(n, 0), random.vector(n, 5), random.vector(n, 0)});
  all.push_back(
      {"fast", random.vector(n, 3), random.vector(n, 1e3), random.vector(n, 5), random.vector(n, 1e3)});
  return all;
}

/// Compares an oracle's poses, Jacobians and dynamics with the definition; CHECK-like macros stay with the
/// caller.
template <class Oracle, class Check>
void compare_with_definition(Oracle& peer, const Definition& definition, const State& state, Check&& check) {
  const std::size_t n = definition.joint_count();
  const auto q = widened(state.q), dq = widened(state.dq), ddq = widened(state.ddq);
  std::vector<double> R(9), p(3), J(6 * n), tau(n), M(n * n);
  const std::vector<double> point{0.1, -0.2, 0.3};
  const auto poses = definition.poses(q);
  for (int b = 0; b < definition.robot().body_count(); ++b) {
    const auto& X = poses[static_cast<std::size_t>(b)];
    peer.pose(b, state.q.data(), R.data(), p.data());
    check("R", difference(R, X.R));
    check("p", difference(p, X.p));
    peer.jacobian(b, point.data(), state.q.data(), J.data());
    check("J", difference(J, definition.jacobian(poses, b, {point[0], point[1], point[2]})));
  }
  peer.mass_matrix(state.q.data(), M.data());
  check("M", difference(M, definition.mass_matrix(q)));
  peer.gravity(state.q.data(), tau.data());
  check("G", difference(tau, definition.gravity(q)));
  peer.inverse_dynamics(state.q.data(), state.dq.data(), state.ddq.data(), tau.data());
  check("inverse dynamics", difference(tau, definition.inverse_dynamics(q, dq, ddq)));
}

}  // namespace oracle
