#include "skinctl/dynamics/momentum_rate.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/mass_matrix.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("momentum_rate: the drift is the gradient of MuJoCo's Lagrangian, the momentum M dq") {
  const auto check = [](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(21);
    double worst = 0, least = 0;
    for (int k = 0; k < 50; ++k) {
      const Motion<N> at(random);
      const auto lagrangian = [&](const JointPosition<N>& q) {
        double potential = 0, kinetic = 0;
        mujoco.energy(q.data, at.dq.data, potential, kinetic);
        return kinetic - potential;
      };
      const auto rate = momentum_rate(robot.model, at.q, at.dq);
      const auto p = mass_matrix(robot.model, at.q) * JointAcceleration<N>(std::to_array(at.dq.data));
      double scale = 0, error = 0;
      for (std::size_t i = 0; i < N; ++i) {
        // Central differences of fourth order.
        const auto along = [&](double h) {
          auto q = at.q;
          q[i] += h;
          return lagrangian(q);
        };
        const double h = 1e-3;
        const double slope = (8 * (along(h) - along(-h)) - (along(2 * h) - along(-2 * h))) / (12 * h);
        scale = std::max(scale, std::abs(slope));
        error = std::max(error, std::abs(rate.drift[i] - slope));
        CHECK(std::abs(rate.momentum[i] - p[i]) <= 1e-11 * (1 + std::abs(p[i])));
      }
      worst = std::max(worst, error / scale);
      least = std::max(least, scale);
    }
    CAPTURE(robot.name);
    CHECK(least > 1e-3);
    CHECK(worst <= 1e-8);
  };
  check(ur5_robot());
  check(allegro_robot());
  check(random_robot<Chain<7>>("chain of 7", 7));
  check(random_robot<MixedTree>("mixed tree", 11));
}
