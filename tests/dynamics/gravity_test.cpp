#include "skinctl/dynamics/gravity.hpp"

#include <doctest/doctest.h>

#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("gravity: KDL and MuJoCo agree at 1000 random states") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::KdlOracle kdl(robot.table);
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      const Motion<N> at(random);
      const auto G = gravity_torque(robot.model, at.q);
      double expected[N];
      kdl.gravity(at.q.data, expected);
      worst = std::max(worst, relative_error(G, expected, N));
      mujoco.gravity(at.q.data, expected);
      worst = std::max(worst, relative_error(G, expected, N));
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-12);
  });
}

TEST_CASE("gravity: it is the slope of the potential energy") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(2);
    for (int k = 0; k < 10; ++k) {
      const Motion<N> at(random);
      CAPTURE(robot.name);
      CHECK(relative_error(gravity_torque(robot.model, at.q), exact.gravity(wide(at.q)), N) <= 1e-14);
      const Digits50 V = exact.potential_energy(wide(at.q));
      CHECK(potential_energy(robot.model, at.q) ==
            doctest::Approx(static_cast<double>(V)).epsilon(1e-12).scale(1));
    }
  });
}

TEST_CASE("gravity: float and double at the straight arm, next to it, and a million turns away") {
  const auto robot = ur5_robot();
  const oracle::EulerLagrange<Digits50> exact(robot.table);
  for (double x : {0.0, 1e-8, 1.0, 3.141592653589793, 1e6}) {
    const auto q = JointPosition<6>::constant(x);
    CAPTURE(x);
    CHECK(relative_error(gravity_torque(robot.model, q), exact.gravity(wide(q)), 6) <= 1e-14);
    const auto qf = q.cast<float>();
    CHECK(relative_error(gravity_torque(robot.model, qf), exact.gravity(wide(qf)), 6) <= 1e-5);
  }
}
