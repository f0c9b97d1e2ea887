#include "skinctl/kinematics/centre_of_mass.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "tests/support/euler_lagrange.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE(
    "CentreOfMass: total moments and total mass of the table, gravity torque, the slope of the position") {
  const auto check = [](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(1);
    double worst = 0, worst_slope = 0;
    for (int k = 0; k < 20; ++k) {
      const Motion<N> at(random);
      const auto com = centre_of_mass(robot.model, at.q);
      Digits50 mass(0);
      std::array<Digits50, 3> moment{};
      const auto X = exact.poses(wide(at.q));
      for (std::size_t i = 0; i < N; ++i) {
        const auto& body = exact.robot().bodies[i];
        mass += body.mass;
        for (std::size_t r = 0; r < 3; ++r) {
          Digits50 x = X[i].p[r];
          for (std::size_t c = 0; c < 3; ++c) x += X[i].R[3 * r + c] * body.com[c];
          moment[r] += body.mass * x;
        }
      }
      for (auto& m : moment) m /= mass;
      CHECK(com.mass == doctest::Approx(static_cast<double>(mass)).epsilon(1e-14));
      const double p[3] = {com.p.x, com.p.y, com.p.z};
      worst = std::max(worst, relative_error(p, moment, 3));

      const auto J = as_eigen(com);
      const auto& g = robot.table.gravity;
      const Eigen::Matrix<double, int(N), 1> G =
          -com.mass * J.transpose() * Eigen::Vector3d(g[0], g[1], g[2]);
      worst = std::max(worst, relative_error(G.data(), exact.gravity(wide(at.q)), N));

      const double h = 1e-5;
      const auto ahead = centre_of_mass(robot.model, integrate(at.q, at.dq, h)),
                 behind = centre_of_mass(robot.model, integrate(at.q, at.dq, -h));
      const auto v = com.velocity(at.dq), d = (ahead.p - behind.p);
      for (double e : {d.x / (2 * h) - v.x, d.y / (2 * h) - v.y, d.z / (2 * h) - v.z})
        worst_slope = std::max(worst_slope, std::abs(e));
    }
    CAPTURE(robot.name);
    CHECK(worst <= 2e-14);
    CHECK(worst_slope <= 1e-8);
  };
  check(ur5_robot());
  check(random_robot<MixedTree>("mixed tree", 11));
}

TEST_CASE("CentreOfMass: float errs by rounding, and a robot without mass has none") {
  oracle::Random random(2);
  const Motion<6> at(random);
  const auto com = centre_of_mass(ur5::Model{}, at.q);
  const auto in_float = centre_of_mass(ur5::Model{}, at.q.cast<float>());
  CHECK(std::abs(double(in_float.p.z) - com.p.z) <= 1e-6);
  auto links = std::array<LinkParameters<double>, 6>{};
  for (std::size_t i = 0; i < 6; ++i) {
    links[i] = ur5::Description::links[i];
    links[i][LinkParameter::mass] = 0;
  }
  const auto nothing = centre_of_mass(ur5::Calibrated<>(links), at.q);
  CHECK(nothing.mass == 0);
  CHECK(as_eigen(nothing).norm() == 0);
}
