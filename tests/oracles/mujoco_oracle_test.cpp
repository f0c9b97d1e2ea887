// not sanitized: it compares the definition and other libraries; nothing of skinctl runs
#include "tests/support/mujoco_oracle.hpp"

#include <doctest/doctest.h>

#include "tests/oracles/agreement.hpp"

using namespace oracle;

TEST_CASE("MuJoCo: agrees with the definition in 50 digits") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const Definition definition(robot);
    const std::size_t n = definition.joint_count();
    MujocoOracle mujoco(robot);
    REQUIRE(mujoco.joint_count() == robot.joint_count());
    for (const State& s : states(21, robot.joint_count())) {
      CAPTURE(s.name);
      compare_with_definition(mujoco, definition, s, [](const char* what, double error) {
        CAPTURE(what);
        CHECK(error < 1e-13);
      });
      const auto q = widened(s.q), dq = widened(s.dq), none = widened(std::vector<double>(n));
      std::vector<double> result(n), tau(n);
      mujoco.bias(s.q.data(), s.dq.data(), result.data());
      CHECK(difference(result, definition.inverse_dynamics(q, dq, none)) < 1e-13);
      double potential = 0, kinetic = 0;
      mujoco.energy(s.q.data(), s.dq.data(), potential, kinetic);
      const double V = static_cast<double>(definition.potential_energy(q));
      const double E = static_cast<double>(definition.kinetic_energy(q, dq));
      CHECK(std::abs(potential - V) <= 1e-13 * std::max(std::abs(V), 1.0));
      CHECK(std::abs(kinetic - E) <= 1e-13 * E);
      if (s.name == "fast") continue;
      mujoco.inverse_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), tau.data());
      mujoco.forward_dynamics(s.q.data(), s.dq.data(), tau.data(), result.data());
      CHECK(difference(result, definition.forward_dynamics(q, dq, widened(tau))) < 1e-10);
    }
  }
}

TEST_CASE("MuJoCo: refuses a body without mass and says so") {
  Robot robot = random_chain(1, 3);
  robot.bodies[1].mass = 0;
  CHECK_THROWS_WITH_AS(MujocoOracle{robot}, doctest::Contains("mass"), std::runtime_error);
}

TEST_CASE("MuJoCo: what benchmarks call computes the same poses and Jacobians") {
  const Robot robot = ur5();
  MujocoOracle mujoco(robot);
  Random random(22);
  const auto q = random.vector(6, 3);
  std::vector<double> X(72), J(36), R(9), p(3), expected(36);
  mujoco.peer_poses(q.data(), X.data());
  mujoco.peer_jacobian(q.data(), J.data());
  for (std::size_t b = 0; b < 6; ++b) {
    mujoco.pose(static_cast<int>(b), q.data(), R.data(), p.data());
    for (std::size_t k = 0; k < 9; ++k) CHECK(X[12 * b + k] == R[k]);
    for (std::size_t k = 0; k < 3; ++k) CHECK(X[12 * b + 9 + k] == p[k]);
  }
  const double origin[3] = {0, 0, 0};
  mujoco.jacobian(5, origin, q.data(), expected.data());
  for (std::size_t k = 0; k < 36; ++k) CHECK(std::abs(J[k] - expected[k]) < 1e-15);
}
