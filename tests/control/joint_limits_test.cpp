#include "skinctl/control/joint_limits.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
using KnownAt = Quantities<Arm, Needs{}>;
static_assert(Law<JointLimitLaw<6>, KnownAt>);
JointLimitSettings<6> settings() {
  JointLimitSettings<6> s;
  s.lower = JointPosition<6>::constant(-1);
  s.upper = JointPosition<6>::constant(2);
  return s;
}
double torque_at(const JointLimitLaw<6>& law, double q, double dq) {
  const State<6> x{0ns, JointPosition<6>::constant(q), JointVelocity<6>::constant(dq)};
  return law.torque(KnownAt(model, x, 0.002, none))[3];
}
}  // namespace

TEST_CASE("JointLimitLaw: zero inside, inwards in the margins, continuous with its slope") {
  const JointLimitLaw<6> law(settings());
  for (double q = -0.79; q < 1.79; q += 0.01) CHECK(torque_at(law, q, 3) == 0);
  CHECK(torque_at(law, 2, 0) == doctest::Approx(-20));
  CHECK(torque_at(law, -1, 0) == doctest::Approx(20));
  CHECK(torque_at(law, 9, 0) == doctest::Approx(-180));
  double last = 0, slope = 0;
  for (double q = 1.7; q < 2.3; q += 1e-4) {
    const double tau = torque_at(law, q, 0);
    CHECK(tau <= last + 1e-12);
    CHECK(magnitude((tau - last) / 1e-4 - slope) < 0.2);
    slope = (tau - last) / 1e-4, last = tau;
  }
  CHECK(torque_at(law, 1.95, 1) < torque_at(law, 1.95, 0));  // damped
  CHECK(torque_at(law, -0.95, -1) > torque_at(law, -0.95, 0));
}

TEST_CASE("JointLimitLaw: stops an arm that swings into it, and gives no energy") {
  const JointLimitLaw<6> law(settings());
  State<6> x{0ns, {}, {}};
  x.q[5] = 1.5, x.dq[5] = 1.0;
  double furthest = 0, fastest_back = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto tau = law.torque(KnownAt(model, x, 0.002, none)) + gravity_torque(model, x.q);
    x = simulate(model, x, tau, 0.002, 1);
    furthest = std::max(furthest, x.q[5]);
    fastest_back = std::min(fastest_back, x.dq[5]);
  }
  CHECK(furthest > 1.8);
  CHECK(furthest < 2.0);
  CHECK(fastest_back > -1.0);
}

TEST_CASE("JointLimitLaw: ranges that cannot be are refused") {
  auto s = settings();
  s.upper[2] = -0.7;
  CHECK_THROWS_AS(JointLimitLaw<6>{s}, ConfigurationError);
  s = settings();
  s.strength[0] = -1;
  CHECK_THROWS_AS(JointLimitLaw<6>{s}, ConfigurationError);
  s = settings();
  s.margin = 0;
  CHECK_THROWS_AS(JointLimitLaw<6>{s}, ConfigurationError);
}
