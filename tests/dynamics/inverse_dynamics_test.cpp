// Promise: `Y_r Theta` holds Christoffel's C: dM/dt - 2C is skew
// Tried: to 1e-13, against the definition in 50 digits

#include "skinctl/dynamics/inverse_dynamics.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("inverse dynamics: KDL and MuJoCo agree at 1000 random states") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::KdlOracle kdl(robot.table);
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst_kdl = 0, worst_mujoco = 0;
    for (int k = 0; k < 1000; ++k) {
      const Motion<N> at(random);
      const auto tau = inverse_dynamics(robot.model, at.q, at.dq, at.ddq);
      double expected[N];
      kdl.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
      worst_kdl = std::max(worst_kdl, relative_error(tau, expected, N));
      mujoco.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
      worst_mujoco = std::max(worst_mujoco, relative_error(tau, expected, N));
    }
    CAPTURE(robot.name);
    CHECK(worst_kdl <= 1e-12);
    CHECK(worst_mujoco <= 1e-12);
  });
}

TEST_CASE("Y_r Theta: M ddq_r + C dq_r + G by definition, with Christoffel's C") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(2);
    double worst = 0;
    for (int k = 0; k < (N > 9 ? 2 : 10); ++k) {
      const Motion<N> at(random);
      const auto tau = yr_theta(robot.model, at.q, at.dq, at.dq_r, at.ddq);
      worst = std::max(
          worst,
          relative_error(tau, exact.yr_theta(wide(at.q), wide(at.dq), wide(at.dq_r), wide(at.ddq)), N));
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-13);
  });
}

TEST_CASE("Y_r Theta: gravity left out is the difference of exactly G") {
  const auto robot = ur5_robot();
  oracle::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Motion<6> at(random);
    const JointAngles<ur5::Model, double> angles(robot.model, at.q);
    const auto with = yr_theta(robot.model, angles, at.dq, at.dq_r, at.ddq);
    const auto without = yr_theta<GravityTerm::left_out>(robot.model, angles, at.dq, at.dq_r, at.ddq);
    CHECK(relative_error(with - without, gravity_torque(robot.model, angles), 6) <= 1e-13);
  }
}

TEST_CASE("C: dM/dt - 2C is skew-symmetric") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(4);
    const Motion<N> at(random);
    using M = typename std::remove_cvref_t<decltype(robot)>::Model;
    const JointAngles<M, double> angles(robot.model, at.q);
    double C[N][N];
    for (std::size_t j = 0; j < N; ++j) {
      JointVelocity<N> unit;
      unit[j] = 1;
      const auto column =
          yr_theta<GravityTerm::left_out>(robot.model, angles, at.dq, unit, JointAcceleration<N>{});
      for (std::size_t i = 0; i < N; ++i) C[i][j] = column[i];
    }
    const auto rate = exact.mass_matrix_rate(wide(at.q), wide(at.dq));
    double scale = 0, worst = 0;
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) {
        const double a = static_cast<double>(rate[i * N + j]) - 2 * C[i][j];
        const double b = static_cast<double>(rate[j * N + i]) - 2 * C[j][i];
        scale = std::max(scale, std::abs(static_cast<double>(rate[i * N + j])));
        worst = std::max(worst, std::abs(a + b));
      }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-13 * scale);
  });
}

TEST_CASE("bias torque: C dq + G, and C dq alone") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    using M = typename std::remove_cvref_t<decltype(robot)>::Model;
    oracle::MujocoOracle mujoco(robot.table);
    oracle::KdlOracle kdl(robot.table);
    oracle::Random random(5);
    for (int k = 0; k < 100; ++k) {
      const Motion<N> at(random);
      const JointAngles<M, double> angles(robot.model, at.q);
      double expected[N];
      mujoco.bias(at.q.data, at.dq.data, expected);
      CAPTURE(robot.name);
      CHECK(relative_error(bias_torque(robot.model, angles, at.dq), expected, N) <= 1e-12);
      kdl.coriolis(at.q.data, at.dq.data, expected);
      CHECK(relative_error(coriolis_torque(robot.model, angles, at.dq), expected, N) <=
            1e-11);  // KDL: a difference
    }
  });
}

TEST_CASE("inverse dynamics: double and float are as close as their rounding allows") {
  const auto robot = ur5_robot();
  const oracle::EulerLagrange<Digits50> exact(robot.table);
  oracle::Random random(6);
  double worst_float = 0, worst_double = 0;
  for (int k = 0; k < 20; ++k) {
    const Motion<6> at(random);
    const auto expected = exact.inverse_dynamics(wide(at.q), wide(at.dq), wide(at.ddq));
    worst_double = std::max(worst_double,
                            relative_error(inverse_dynamics(robot.model, at.q, at.dq, at.ddq), expected, 6));
    const auto qf = at.q.cast<float>();
    const auto vf = at.dq.cast<float>();
    const auto af = at.ddq.cast<float>();
    worst_float =
        std::max(worst_float, relative_error(inverse_dynamics(robot.model, qf, vf, af),
                                             exact.inverse_dynamics(wide(qf), wide(vf), wide(af)), 6));
  }
  CHECK(worst_double <= 16 * std::numeric_limits<double>::epsilon());
  CHECK(worst_float <= 16 * std::numeric_limits<float>::epsilon());
}

#if SKINCTL_MANY_DIGITS
TEST_CASE("inverse dynamics: in 50 digits it is the definition, to the rounding of the definition") {
  // Numbers that are exact in binary, so that nothing but the algorithm differs.
  oracle::Robot table;
  std::array<PlacedLink, 3> links;
  for (std::size_t i = 0; i < 3; ++i) {
    oracle::Body b;
    b.parent = static_cast<int>(i) - 1;
    b.R = {1, 0, 0, 0, 0, i == 1 ? 1. : -1., 0, i == 1 ? -1. : 1., 0};
    b.p = {0.25, -0.5, 0.125};
    b.mass = 2;
    b.com = {0.125, 0.0625, -0.25};
    b.inertia = {0.5, 0.0625, -0.03125, 0.0625, 0.75, 0.125, -0.03125, 0.125, 1};
    table.bodies.push_back(b);
    links[i] = placed(b);
  }
  table.gravity = {0.5, -1, -9.75};
  const auto numbers = canonical_links<Chain<3>>(links).links;
  CalibratedModel<Chain<3>, Digits50>::Links wide_numbers;
  for (std::size_t i = 0; i < 3; ++i) wide_numbers[i] = numbers[i].cast<Digits50>();
  const CalibratedModel<Chain<3>, Digits50> model(wide_numbers,
                                                  {Digits50(0.5), Digits50(-1), Digits50(-9.75)});
  const oracle::EulerLagrange<Digits50> exact(table);
  oracle::Random random(12);
  for (int k = 0; k < 10; ++k) {
    const Motion<3, Digits50> at(random);
    const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
    const auto G = gravity_torque(model, at.q);
    const auto M = mass_matrix(model, at.q);
    CHECK(relative_error(G, exact.gravity(wide(at.q)), 3) <= 1e-40);
    CHECK(relative_error(M.data, exact.mass_matrix(wide(at.q)), 9) <= 1e-40);
    CHECK(relative_error(tau, exact.inverse_dynamics(wide(at.q), wide(at.dq), wide(at.ddq)), 3) <= 1e-28);
  }
}
#endif

TEST_CASE("inverse dynamics: the four fingers as lanes are the hand") {
  const auto hand = allegro::right_hand();
  constexpr std::size_t W = native_lanes<double>;
  oracle::Random random(7);
  for (int k = 0; k < 100; ++k) {
    const Motion<16> at(random);
    const auto tau = inverse_dynamics(hand, at.q, at.dq, at.ddq);
    if constexpr (W > 1) {
      for (std::size_t first = 0; first < 4; first += W) {
        const auto fingers = allegro::right_fingers<W>(first);
        const auto side_by_side =
            inverse_dynamics(fingers, allegro::to_lanes<W>(at.q, first), allegro::to_lanes<W>(at.dq, first),
                             allegro::to_lanes<W>(at.ddq, first));
        JointTorque<16> back = tau;
        allegro::from_lanes(side_by_side, back, first);
        CHECK(back[4 * first + 5] == side_by_side[1][1]);
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t f = 0; f < W; ++f)
            CHECK(side_by_side[i][f] == doctest::Approx(tau[4 * (first + f) + i]).epsilon(1e-13).scale(0.1));
      }
    }
  }
}

TEST_CASE("inverse dynamics: nothing is allocated, a NaN stays a NaN") {
  const auto robot = ur5_robot();
  oracle::Random random(8);
  const Motion<6> at(random);
  const AllocationGuard guard;
  auto tau = inverse_dynamics(robot.model, at.q, at.dq, at.ddq);
  CHECK(guard.count() == 0);
  auto q = at.q;
  q[2] = std::numeric_limits<double>::quiet_NaN();
  tau = inverse_dynamics(robot.model, q, at.dq, at.ddq);
  CHECK(tau[1] != tau[1]);
}
