#include "skinctl/dynamics/regressor.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(sizeof(Regressor<ur5::Model>) == 21 * 10 * sizeof(double), "the lower half is all there is");

namespace {

/// The table with other inertias: what the parameters `theta`, in the model's link frames, are to the oracle.
template <class R>
oracle::BasicRobot<Digits50> with_parameters(const R& robot, const auto& theta) {
  auto table = oracle::exact<Digits50>(robot.table);
  for (std::size_t i = 0; i < R::joints; ++i) {
    auto& body = table.bodies[i];
    const auto t = [&](Inertial p) { return Digits50(theta(i, p)); };
    using P = Inertial;
    const Digits50 m = t(P::mass), x = t(P::h_x) / m, y = t(P::h_y) / m, z = t(P::h_z) / m;
    const Digits50 xy = t(P::xy) + m * x * y, xz = t(P::xz) + m * x * z, yz = t(P::yz) + m * y * z;
    body.mass = m;
    body.com = {x, y, z};
    body.inertia = {t(P::xx) - m * (y * y + z * z), xy, xz, xy, t(P::yy) - m * (x * x + z * z), yz, xz, yz,
                    t(P::zz) - m * (x * x + y * y)};
  }
  return table;
}

}  // namespace

TEST_CASE("Regressor: with the model's own parameters it is Y_r Theta") {
  const auto check = [](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    const auto theta = inertial_parameters(robot.model);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 200; ++k) {
      const Motion<N> at(random);
      const auto expected = yr_theta(robot.model, at.q, at.dq, at.dq_r, at.ddq);
      const auto Y = regressor(robot.model, at.q, at.dq, at.dq_r, at.ddq);
      worst = std::max(worst, relative_error(Y * theta, expected, N));
      const auto direct = regressor_product(robot.model, at.q, at.dq, at.dq_r, at.ddq, theta);
      worst = std::max(worst, relative_error(direct, expected, N));
    }
    CAPTURE(robot.name);
    CHECK(worst <= 2e-14);
  };
  check(ur5_robot());
  check(random_robot<MixedTree>("mixed tree", 11));
}

TEST_CASE(
    "Regressor: any parameters, bodies that cannot exist included, against the definition in 50 digits") {
  const auto robot = ur5_robot();
  oracle::Random random(2);
  double worst = 0, worst_float = 0;
  for (int k = 0; k < 10; ++k) {
    const Motion<6> at(random);
    InertialParameters<6> theta;
    for (double& x : theta.data) x = random.uniform(-2, 2);  // negative masses and moments among them
    const oracle::EulerLagrange<Digits50> exact(with_parameters(robot, theta));
    const auto expected = exact.yr_theta(wide(at.q), wide(at.dq), wide(at.dq_r), wide(at.ddq));
    const auto tau = regressor(robot.model, at.q, at.dq, at.dq_r, at.ddq) * theta;
    worst = std::max(worst, relative_error(tau, expected, 6));

    InertialParameters<6, float> theta_f;
    for (std::size_t i = 0; i < theta.size; ++i) theta_f.data[i] = static_cast<float>(theta.data[i]);
    const auto tau_f = regressor_product(robot.model, at.q.cast<float>(), at.dq.cast<float>(),
                                         at.dq_r.cast<float>(), at.ddq.cast<float>(), theta_f);
    worst_float = std::max(worst_float, relative_error(tau_f, expected, 6));
  }
  CHECK(worst <= 1e-14);
  CHECK(worst_float <= 1e-5);
}

TEST_CASE("Regressor: linear in the parameters, and its transpose without forming it") {
  const auto robot = random_robot<MixedTree>("mixed tree", 11);
  oracle::Random random(3);
  for (int k = 0; k < 50; ++k) {
    const Motion<9> at(random);
    const auto Y = regressor(robot.model, at.q, at.dq, at.dq_r, at.ddq);
    InertialParameters<9> theta;
    for (double& x : theta.data) x = random.uniform(-5, 5);
    const auto tau = Y * theta;
    const auto direct = regressor_product(robot.model, at.q, at.dq, at.dq_r, at.ddq, theta);
    CHECK(relative_error(direct, tau, 9) <= 1e-13);
    const Eigen::Matrix<double, 9, 1> dense =
        as_eigen(Y) * Eigen::Map<const Eigen::Matrix<double, 90, 1>>(theta.data);
    CHECK(relative_error(dense.data(), tau, 9) <= 1e-13);

    const auto S_q = at.dq - at.dq_r;
    const auto gradient = regressor_transposed_product(robot.model, at.q, at.dq, at.dq_r, at.ddq, S_q);
    const Eigen::Matrix<double, 90, 1> expected = as_eigen(Y).transpose() * as_eigen(S_q);
    CHECK(relative_error(gradient.data, expected.data(), 90) <= 1e-13);
    CHECK(Y.block(2, 4) == nullptr);  // link 4 does not hang on joint 2
  }
}
