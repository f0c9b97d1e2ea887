// not sanitized: it compares the definition and other libraries; nothing of skinctl runs
#include "tests/support/kdl_oracle.hpp"

#include <doctest/doctest.h>

#include "tests/oracles/agreement.hpp"

using namespace oracle;

TEST_CASE("KDL: agrees with the definition in 50 digits") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const Definition definition(robot);
    const std::size_t n = definition.joint_count();
    KdlOracle kdl(robot);
    REQUIRE(kdl.joint_count() == robot.joint_count());
    for (const State& s : states(11, robot.joint_count())) {
      CAPTURE(s.name);
      compare_with_definition(kdl, definition, s, [](const char* what, double error) {
        CAPTURE(what);
        CHECK(error < 1e-13);
      });
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
      std::vector<double> result(n), tau(n);
      kdl.coriolis(s.q.data(), s.dq.data(), result.data());
      CHECK(difference(result, definition.coriolis(q, dq, dq)) < 1e-13);
      if (!robot.is_chain() || s.name == "fast") continue;
      kdl.inverse_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), tau.data());
      kdl.forward_dynamics(s.q.data(), s.dq.data(), tau.data(), result.data());
      CHECK(difference(result, definition.forward_dynamics(q, dq, widened(tau))) < 1e-10);
    }
  }
}

TEST_CASE("KDL: what benchmarks call computes the same poses") {
  const Robot robot = ur5(), hand = allegro_right();
  KdlOracle arm(robot), tree(hand);
  Random random(12);
  const auto q = random.vector(16, 3);
  std::vector<double> X(12 * 20), J(6 * 16 * 4), R(9), p(3);
  arm.peer_poses(q.data(), X.data());
  for (int b = 0; b < 6;
       ++b) {  // the frame of body b, seen from the next joint: same place, then the next placement
    arm.pose(b, q.data(), R.data(), p.data());
    if (b < 5) {
      const Body& next = robot.body(b + 1);
      const auto turned = table_detail::product(
          std::array<double, 9>{R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]}, next.R);
      const auto step = table_detail::product(
          std::array<double, 9>{R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]}, next.p);
      std::copy(turned.begin(), turned.end(), R.begin());
      for (std::size_t k = 0; k < 3; ++k) p[k] += step[k];
    }
    for (std::size_t k = 0; k < 9; ++k)
      CHECK(std::abs(X[static_cast<std::size_t>(12 * b) + k] - R[k]) < 1e-14);
    for (std::size_t k = 0; k < 3; ++k)
      CHECK(std::abs(X[static_cast<std::size_t>(12 * b) + 9 + k] - p[k]) < 1e-14);
  }
  std::vector<double> expected(6 * 16);
  const double origin[3] = {0, 0, 0};
  arm.peer_jacobian(q.data(), J.data());
  arm.jacobian(5, origin, q.data(), expected.data());
  for (std::size_t k = 0; k < 36; ++k) CHECK(std::abs(J[k] - expected[k]) < 1e-14);
  tree.peer_poses(q.data(), X.data());
  tree.peer_jacobian(q.data(), J.data());
  for (int f = 0; f < 4; ++f) {
    tree.pose(16 + f, q.data(), R.data(), p.data());
    for (std::size_t k = 0; k < 9; ++k) CHECK(X[static_cast<std::size_t>(12 * (16 + f)) + k] == R[k]);
    tree.jacobian(16 + f, origin, q.data(), expected.data());
    for (std::size_t k = 0; k < 96; ++k)
      CHECK(std::abs(J[static_cast<std::size_t>(96 * f) + k] - expected[k]) < 1e-14);
  }
}
