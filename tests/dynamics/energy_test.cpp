#include "skinctl/dynamics/energy.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/dynamics/momentum_rate.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("energy: MuJoCo's, and half of dq' M dq") {
  const auto check = [](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 200; ++k) {
      const Motion<N> at(random);
      double potential = 0, kinetic = 0;
      mujoco.energy(at.q.data, at.dq.data, potential, kinetic);
      const double T = kinetic_energy(robot.model, at.q, at.dq);
      worst = std::max(worst, std::abs(T - kinetic) / kinetic);
      worst = std::max(worst, std::abs(energy(robot.model, at.q, at.dq) - potential - kinetic) /
                                  (std::abs(potential) + kinetic));
      const auto p = mass_matrix(robot.model, at.q) * JointAcceleration<N>(std::to_array(at.dq.data));
      double twice = 0;
      for (std::size_t i = 0; i < N; ++i) twice += p[i] * at.dq[i];
      worst = std::max(worst, std::abs(T - twice / 2) / T);
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-12);
  };
  check(ur5_robot());
  check(random_robot<MixedTree>("mixed tree", 11));
}

#if SKINCTL_MANY_DIGITS
TEST_CASE("energy: changes as the joints do work, and momentum as dp = tau + C' dq - G, in 50 digits") {
  const auto model = calibrated_from<ur5::Description, Digits50>();
  oracle::Random random(2);
  const Digits50 h("1e-16");
  for (int k = 0; k < 3; ++k) {
    const Motion<6, Digits50> at(random);
    const auto E = [&](const Digits50& t) {
      const auto q = JointPosition<6, Digits50>::generate(
          [&](std::size_t i) { return at.q[i] + t * at.dq[i] + t * t / 2 * at.ddq[i]; });
      return energy(model, q, integrate(at.dq, at.ddq, t));
    };
    const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
    const Digits50 rate = (E(h) - E(-h)) / (2 * h);
    CHECK(static_cast<double>(abs(rate - power(tau, at.dq))) <= 1e-25);
    // C' dq is the gradient of the kinetic energy, and so C' dq - G that of the Lagrangian.
    const auto p = [&](const Digits50& t) {
      return momentum_rate(model, integrate(at.q, at.dq, t), integrate(at.dq, at.ddq, t)).momentum;
    };
    const auto p_ahead = p(h), p_behind = p(Digits50(-h));
    for (std::size_t i = 0; i < 6; ++i) {
      auto q_plus = at.q, q_minus = at.q;
      q_plus[i] += h, q_minus[i] -= h;
      const Digits50 gradient = (kinetic_energy(model, q_plus, at.dq) - potential_energy(model, q_plus) -
                                 kinetic_energy(model, q_minus, at.dq) + potential_energy(model, q_minus)) /
                                (2 * h);
      CHECK(static_cast<double>(abs((p_ahead[i] - p_behind[i]) / (2 * h) - tau[i] - gradient)) <= 1e-25);
    }
  }
}
#endif

TEST_CASE("energy: float errs by rounding") {
  oracle::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Motion<6, float> at(random);
    const ur5::Model model;
    const double exact = kinetic_energy(model, at.q.cast<double>(), at.dq.cast<double>());
    CHECK(std::abs(double(kinetic_energy(model, at.q, at.dq)) - exact) <= 2e-6 * exact);
  }
}
