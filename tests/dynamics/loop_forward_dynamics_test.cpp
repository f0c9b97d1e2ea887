#include "skinctl/dynamics/loop_forward_dynamics.hpp"

#include <doctest/doctest.h>

#include "tests/support/digits.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// Undoes inverse dynamics on a chain of 64 joints, and M is the definition's.
template <class T>
void check_chain() {
  const auto robot = random_robot<Chain<64>>("chain of 64", 64);
  const auto model = random_robot<Chain<64>, T>("chain of 64", 64).model;
  const oracle::EulerLagrange<Digits50> exact(robot.table);
  oracle::Random random(2);
  const Motion<64, T> at(random);
  const double eps = static_cast<double>(std::numeric_limits<T>::epsilon());
  const auto M = loop_mass_matrix(model, at.q);
  CHECK(relative_error(M.data, exact.mass_matrix(wide(at.q)), 64 * 64) <= 256 * eps);
  const auto rest = std::vector<Digits50>(64, Digits50(0));
  CHECK(relative_error(loop_gravity_torque(model, at.q), exact.dalembert(wide(at.q), rest, rest), 64) <=
        256 * eps);
  // M times the answer is what was left of the torque.
  JointTorque<64, T> tau;
  for (std::size_t i = 0; i < 64; ++i) tau[i] = 10 * at.dq_r[i];
  const auto result = loop_forward_dynamics(model, at.q, at.dq, tau);
  CHECK(result.positive_definite);
  const auto back = loop_yr_theta(model, at.q, at.dq, at.dq, result.acceleration);
  double scale = 0;
  for (const T& x : M* result.acceleration) scale = std::max(scale, std::abs(static_cast<double>(x)));
  for (const T& x : loop_yr_theta(model, at.q, at.dq, at.dq, JointAcceleration<64, T>()))
    scale = std::max(scale, std::abs(static_cast<double>(x)));
  for (std::size_t i = 0; i < 64; ++i)
    CHECK(std::abs(static_cast<double>(back[i] - tau[i])) <= 4096 * eps * scale);
}
}  // namespace

#if SKINCTL_MANY_DIGITS  // the sanitizers take a minute to compile the straight-line code
TEST_CASE("loop forward dynamics: what straight-line code gives, on a tree with sliding joints") {
  const auto robot = random_robot<MixedTree>("mixed tree", 11);
  oracle::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Motion<9> at(random);
    CHECK(relative_error(loop_mass_matrix(robot.model, at.q).data, mass_matrix(robot.model, at.q).data, 81) <=
          1e-14);
    CHECK(relative_error(loop_gravity_torque(robot.model, at.q),
                         loop_yr_theta(robot.model, at.q, {}, {}, JointAcceleration<9>()), 9) == 0);
    JointTorque<9> tau;
    for (std::size_t i = 0; i < 9; ++i) tau[i] = 10 * at.dq_r[i];
    const auto mine = loop_forward_dynamics(robot.model, at.q, at.dq, tau);
    CHECK(mine.positive_definite);
    CHECK(relative_error(mine.acceleration, forward_dynamics(robot.model, at.q, at.dq, tau).acceleration,
                         9) <= 1e-12);
  }
}

#endif

TEST_CASE("loop forward dynamics: a chain of 64 joints, float and double") {
  check_chain<double>();
  check_chain<float>();
}

TEST_CASE("loop forward dynamics: a joint without mass is taken out, not divided by") {
  CalibratedModel<Chain<2>>::Links links;
  links[0] = make_link({.p = {0.3, 0, 0}}, {1, {0.1, 0, 0}, 0.01, 0.01, 0.01});
  links[1] = make_link({.p = {0.3, 0, 0}}, {});
  const CalibratedModel<Chain<2>> model(links);
  const auto result =
      loop_forward_dynamics(model, JointPosition<2>{}, JointVelocity<2>{}, JointTorque<2>{1., 1.});
  CHECK_FALSE(result.positive_definite);
  CHECK(result.acceleration[1] == 0);
  CHECK(result.acceleration[0] > 0);
}
