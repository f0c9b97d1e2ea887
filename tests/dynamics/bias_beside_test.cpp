#include "skinctl/dynamics/detail/bias_beside.hpp"

#include <doctest/doctest.h>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("bias beside a recursion: both are what each is alone") {
  for_each_robot([](const auto& robot) {
    using M = std::remove_cvref_t<decltype(robot.model)>;
    if constexpr (skinctl::detail::computes_in_pairs<M, double>) {
      constexpr std::size_t N = std::remove_cvref_t<decltype(robot)>::joints;
      oracle::Random random(5);
      double worst = 0;
      for (int k = 0; k < 200; ++k) {
        const Motion<N> at(random), other(random);
        const JointAngles<M, double> angles(robot.model, at.q), ahead(robot.model, other.q);
        const skinctl::detail::RecursionMotion<JointAngles<M, double>, N, double> motion{angles, at.dq,
                                                                                         at.dq_r, at.ddq, 1};
        skinctl::detail::BiasBeside<N, double> beside;
        beside.v = other.dq;
        JointTorque<N> tau;
        skinctl::detail::run_recursion_beside<true>(robot.model, motion, tau, ahead, 1.0, beside);
        CHECK(beside.known);
        worst =
            std::max(worst, relative_error(tau, yr_theta(robot.model, angles, at.dq, at.dq_r, at.ddq), N));
        worst = std::max(worst, relative_error(beside.bias, bias_torque(robot.model, ahead, other.dq), N));
        // Where a law reads gravity itself, it counts for neither.
        auto weightless = motion;
        weightless.gravity = 0;
        skinctl::detail::run_recursion_beside<false>(robot.model, weightless, tau, ahead, 0.0, beside);
        const auto without = yr_theta<GravityTerm::left_out>(robot.model, angles, at.dq, at.dq_r, at.ddq);
        worst = std::max(worst, relative_error(tau, without, N));
        worst =
            std::max(worst, relative_error(beside.bias, coriolis_torque(robot.model, ahead, other.dq), N));
      }
      CAPTURE(robot.name);
      CHECK(worst <= 1e-13);
    }
  });
}

TEST_CASE("bias beside a recursion: NaN of one does not reach the other") {
  if constexpr (skinctl::detail::computes_in_pairs<ur5::Model, double>) {
    const auto robot = ur5_robot();
    oracle::Random random(6);
    const Motion<6> at(random), other(random);
    const JointAngles<ur5::Model, double> angles(robot.model, at.q), ahead(robot.model, other.q);
    auto nan = at.dq_r;
    nan[3] = std::numeric_limits<double>::quiet_NaN();
    const skinctl::detail::RecursionMotion<JointAngles<ur5::Model, double>, 6, double> motion{angles, at.dq,
                                                                                              nan, at.ddq, 1};
    skinctl::detail::BiasBeside<6, double> beside;
    beside.v = other.dq;
    JointTorque<6> tau;
    skinctl::detail::run_recursion_beside<true>(robot.model, motion, tau, ahead, 1.0, beside);
    CHECK(tau[3] != tau[3]);
    CHECK(relative_error(beside.bias, bias_torque(robot.model, ahead, other.dq), 6) <= 1e-13);
  }
}
