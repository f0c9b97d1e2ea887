#include "skinctl/dynamics/forward_dynamics.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/gravity.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("forward dynamics: MuJoCo agrees at 1000 random states") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      const Motion<N> at(random);
      JointTorque<N> tau;
      for (std::size_t i = 0; i < N; ++i) tau[i] = 10 * at.dq_r[i];
      const auto result = forward_dynamics(robot.model, at.q, at.dq, tau);
      double expected[N];
      mujoco.forward_dynamics(at.q.data, at.dq.data, tau.data, expected);
      worst = std::max(worst, relative_error(result.acceleration, expected, N));
      CHECK(result.positive_definite);
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-11);  // both solve with M, whose condition reaches 1e4
  });
}

TEST_CASE("forward dynamics: undoes inverse dynamics, in float as far as the condition allows") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::Random random(2);
    for (int k = 0; k < 200; ++k) {
      const Motion<N> at(random);
      const auto tau = inverse_dynamics(robot.model, at.q, at.dq, at.ddq);
      CAPTURE(robot.name);
      CHECK(relative_error(forward_dynamics(robot.model, at.q, at.dq, tau).acceleration, at.ddq, N) <= 1e-9);
    }
  });
  const ur5::Model model;
  oracle::Random random(3);
  for (int k = 0; k < 200; ++k) {
    const Motion<6, float> at(random);
    const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
    CHECK(relative_error(forward_dynamics(model, at.q, at.dq, tau).acceleration, at.ddq, 6) <= 0.05);
  }
}

TEST_CASE("forward dynamics: a passive robot keeps its energy") {
  // Fourth-order Runge-Kutta from a random state: the error in energy shrinks with the fourth power of the
  // step.
  const ur5::Model model;
  oracle::Random random(4);
  const Motion<6> start(random);
  const auto energy = [&](const auto& q, const auto& dq) {
    JointAcceleration<6> as_acceleration;
    for (std::size_t i = 0; i < 6; ++i) as_acceleration[i] = dq[i];
    return 0.5 * power(mass_matrix(model, q) * as_acceleration, dq) + potential_energy(model, q);
  };
  const auto drift = [&](int steps) {
    auto q = start.q;
    auto dq = start.dq;
    const double h = 0.5 / steps;
    const double before = energy(q, dq);
    for (int k = 0; k < steps; ++k) {
      const auto slope = [&](const auto& at, const auto& v) {
        return forward_dynamics(model, at, v, JointTorque<6>{}).acceleration;
      };
      const auto v1 = dq;
      const auto a1 = slope(q, v1);
      const auto v2 = integrate(dq, a1, h / 2);
      const auto a2 = slope(integrate(q, v1, h / 2), v2);
      const auto v3 = integrate(dq, a2, h / 2);
      const auto a3 = slope(integrate(q, v2, h / 2), v3);
      const auto v4 = integrate(dq, a3, h);
      const auto a4 = slope(integrate(q, v3, h), v4);
      q = integrate(q, v1 + 2. * v2 + 2. * v3 + v4, h / 6);
      dq = integrate(dq, a1 + 2. * a2 + 2. * a3 + a4, h / 6);
    }
    return std::abs(energy(q, dq) - before);
  };
  const double coarse = drift(1000), fine = drift(4000);
  CHECK(coarse <= 1e-5);
  CHECK(fine <= std::max(coarse / 100, 1e-10));
}

TEST_CASE("forward dynamics: a joint without mass is taken out, not divided by") {
  CalibratedModel<Chain<2>>::Links links;
  for (auto& l : links) l = make_link({.p = {0.3, 0, 0}}, {1, {0.1, 0, 0}, 0.01, 0.01, 0.01});
  links[1] = make_link({.p = {0.3, 0, 0}}, {});
  const CalibratedModel<Chain<2>> model(links);
  const auto result = forward_dynamics(model, JointPosition<2>{}, JointVelocity<2>{}, JointTorque<2>{1., 1.});
  CHECK_FALSE(result.positive_definite);
  CHECK(result.acceleration[1] == doctest::Approx(0));
  CHECK(result.acceleration[0] > 0);
  auto nan = mass_matrix(ur5::Model{}, JointPosition<6>{});
  nan(3, 3) = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(MassFactors<ur5::Model>(nan).positive_definite());
}
