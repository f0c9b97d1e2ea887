// by night: a world of studies
//
// Promise: rounding does not add up
// Tried: three runs rounded by lot, 200 000 sub-steps of goals and touches: 1.3e-15 rad apart in double.
// Also: study `rounding`

#include "bench/studies/worlds/stochastic.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;
using skinctl::testing::Stochastic;
TEST_CASE_TEMPLATE("Stochastic: exact results stay, others go to either neighbour half of the time", R, float,
                   double) {
  using S = Stochastic<R>;
  S::seed() = 11;
  int above = 0;
  const R nearest = R(1) / R(3);
  for (int k = 0; k < 2000; ++k) {
    const R x = static_cast<R>(S(1) / S(3));
    CHECK(std::abs(x - nearest) <= std::numeric_limits<R>::epsilon() / 2);
    above += x != nearest;
    CHECK(static_cast<R>(S(R(0.75)) + S(R(0.5))) == R(1.25));
    CHECK(static_cast<R>(S(3) / S(4)) == R(0.75));
    CHECK(static_cast<R>(S(-3) * S(R(0.5))) == R(-1.5));
    CHECK(static_cast<R>(sqrt(S(9))) == R(3));
    const R sum = static_cast<R>(S(1) + S(std::numeric_limits<R>::epsilon() / 8));
    CHECK((sum == R(1) || sum == R(1) + std::numeric_limits<R>::epsilon()));
    // The neighbours enclose the exact quotient: 3 x is below 1 on one side, above on the other.
    CHECK(std::abs(std::fma(R(3), x, R(-1))) <= 2 * std::numeric_limits<R>::epsilon());
  }
  CHECK(above > 900);
  CHECK(above < 1100);
}

TEST_CASE("Stochastic: the spread of forward dynamics tells the digits it has") {
  const ur5::Model model;
  JointPosition<6, Stochastic<float>> q;
  JointVelocity<6, Stochastic<float>> dq;
  JointTorque<6, Stochastic<float>> tau;
  for (std::size_t i = 0; i < 6; ++i) q[i] = 0.3 * double(i) - 1, dq[i] = 1, tau[i] = 5;
  std::vector<double> found;
  for (int k = 0; k < 200; ++k)
    found.push_back(static_cast<double>(forward_dynamics(model, q, dq, tau).acceleration[5]));
  const auto [least, most] = std::minmax_element(found.begin(), found.end());
  const double exact = static_cast<double>(
      forward_dynamics(model, q.cast<double>(), dq.cast<double>(), tau.cast<double>()).acceleration[5]);
  CHECK(*least < exact);
  CHECK(exact < *most);
  CHECK((*most - *least) < 1e-4 * std::abs(exact));
  CHECK((*most - *least) > 1e-7 * std::abs(exact));
}
