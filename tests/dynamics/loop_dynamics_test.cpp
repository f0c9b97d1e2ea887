#include "skinctl/dynamics/loop_dynamics.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("loop dynamics: what straight-line code gives, on a tree with sliding joints") {
  const auto robot = random_robot<MixedTree>("mixed tree", 11);
  oracle::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Motion<9> at(random);
    const auto tau = loop_yr_theta(robot.model, at.q, at.dq, at.dq_r, at.ddq);
    CHECK(relative_error(tau, yr_theta(robot.model, at.q, at.dq, at.dq_r, at.ddq), 9) <= 1e-14);
    const auto X = loop_poses(robot.model, at.q);
    const auto expected = link_poses(robot.model, at.q).get<4>();
    const auto d = X.origin[4] - expected.origin();
    CHECK(dot(d, d) <= 1e-28);
    CHECK(std::abs(dot(X.axes[4].x, expected.axes().x) - 1) <= 1e-14);
    const auto p = expected.origin() + expected.axes() * Xyz<double>{0.1, -0.2, 0.3};
    const auto mine = loop_jacobian<MixedTree>(X, 4, p);
    const auto J =
        jacobian<4>(link_poses(robot.model, at.q), Transform<Link<4>, Cell>::translation_xyz(0.1, -0.2, 0.3));
    double sum = 0;
    J.for_each([&](auto j, const auto& c) {
      const auto a = mine.linear[j] - c.linear, b = mine.angular[j] - c.angular;
      sum += dot(a, a) + dot(b, b);
    });
    CHECK(sum <= 1e-28);
    CHECK(mine.linear[2] == Xyz<double>{0, 0, 0});  // joint 2 does not move link 4
  }
}

TEST_CASE("loop dynamics: a chain of 64 joints against the definition in 50 digits") {
  constexpr int n = sanitized ? 16 : 64;
  const auto robot = random_robot<Chain<n>>("chain of 64", n);
  const oracle::EulerLagrange<Digits50> exact(robot.table);
  oracle::Random random(2);
  const Motion<n> at(random);
  const auto X = loop_poses(robot.model, at.q);
  const auto expected = exact.pose(n - 1, wide(at.q));
  const double p[3] = {X.origin[n - 1].x, X.origin[n - 1].y, X.origin[n - 1].z};
  CHECK(relative_error(p, expected.p, 3) <= 1e-13);
  const auto tau = loop_yr_theta(robot.model, at.q, at.dq, at.dq_r, at.ddq);
  const auto sum = exact.yr_theta(wide(at.q), wide(at.dq), wide(at.dq_r), wide(at.ddq));
  const double error = relative_error(tau, sum, n);
  CHECK(error <= 1e-13);
  // In float the same to rounding.
  const auto rough = random_robot<Chain<n>, float>("chain of 64", n);
  const auto tau_f = loop_yr_theta(rough.model, at.q.cast<float>(), at.dq.cast<float>(),
                                   at.dq_r.cast<float>(), at.ddq.cast<float>());
  CHECK(relative_error(tau_f, sum, n) <= 1e-4);
}
