#include "skinctl/dynamics/mass_matrix.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/euler_lagrange.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<MassMatrix<6>>);

TEST_CASE("mass matrix: KDL and MuJoCo agree at 1000 random states") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    oracle::KdlOracle kdl(robot.table);
    oracle::MujocoOracle mujoco(robot.table);
    oracle::Random random(1);
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      const Motion<N> at(random);
      const auto M = mass_matrix(robot.model, at.q);
      double expected[N * N];
      kdl.mass_matrix(at.q.data, expected);
      worst = std::max(worst, relative_error(M.data, expected, N * N));
      mujoco.mass_matrix(at.q.data, expected);
      worst = std::max(worst, relative_error(M.data, expected, N * N));
    }
    CAPTURE(robot.name);
    CHECK(worst <= 1e-12);
  });
}

TEST_CASE("mass matrix: the definition in 50 digits; symmetric to the bit; branches do not couple") {
  for_each_robot([](const auto& robot) {
    constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
    using Model = typename std::remove_cvref_t<decltype(robot)>::Model;
    const oracle::EulerLagrange<Digits50> exact(robot.table);
    oracle::Random random(2);
    for (int k = 0; k < 10; ++k) {
      const Motion<N> at(random);
      const auto M = mass_matrix(robot.model, at.q);
      CAPTURE(robot.name);
      CHECK(relative_error(M.data, exact.mass_matrix(wide(at.q)), N * N) <= 1e-14);
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j < N; ++j) {
          CHECK(M(i, j) == M(j, i));
          const bool coupled =
              ((ancestors<Model>(i) >> j) & 1u) != 0 || ((ancestors<Model>(j) >> i) & 1u) != 0;
          if (!coupled) CHECK(M(i, j) == 0);
        }
    }
  });
}

TEST_CASE("mass matrix: times an acceleration it is the torque of that acceleration") {
  const auto robot = ur5_robot();
  oracle::Random random(3);
  for (int k = 0; k < 100; ++k) {
    const Motion<6> at(random);
    const JointAngles<ur5::Model, double> angles(robot.model, at.q);
    const auto by_recursion =
        inverse_dynamics(robot.model, angles, at.dq, at.ddq) - bias_torque(robot.model, angles, at.dq);
    CHECK(relative_error(mass_matrix(robot.model, angles) * at.ddq, by_recursion, 6) <= 1e-13);
  }
}

TEST_CASE_TEMPLATE("mass matrix: is seen by Eigen in place, and comes back", T, float, double) {
  const auto M = mass_matrix(ur5::Model{}, JointPosition<6, T>{T(0), T(-1), T(1), T(-2), T(-1), T(0)});
  CHECK(as_eigen(M).data() == M.data);
  const MassMatrix<6, T> back(as_eigen(M));
  for (std::size_t i = 0; i < 36; ++i) CHECK(back.data[i] == M.data[i]);
  const JointAcceleration<6, T> ddq{T(1), T(2), T(3), T(4), T(5), T(6)};
  const auto tau = M * ddq;
  CHECK((as_eigen(M) * as_eigen(ddq) - as_eigen(tau)).norm() <= tolerance<T> * as_eigen(tau).norm());
}
template <class Q>
concept viewed = requires(Q&& x) { as_eigen(static_cast<Q&&>(x)); };
static_assert(viewed<const MassMatrix<6>&> && viewed<MassMatrix<6>&> && !viewed<MassMatrix<6>>);
