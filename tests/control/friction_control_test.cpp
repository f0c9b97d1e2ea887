#include "skinctl/control/friction_control.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {
JointFriction<6> friction() {
  JointFriction<6>::Settings s;
  s.viscous = JointTorque<6>::constant(2);
  s.coulomb = JointTorque<6>::constant(5);
  return JointFriction<6>(s);
}
using Arm = ur5::Model;
}  // namespace

TEST_CASE("FrictionControl: a share of what friction takes, and never more") {
  const FrictionControl<6> law(friction(), 0.8);
  static_assert(FrictionControl<6>::compensates_friction);
  static_assert(decltype(law + GravityControl{})::compensates_friction, "a sum says so as well");
  const Arm model;
  const NoTouch none;
  for (const double v : {-2.0, -0.1, 0.0, 0.003, 1.0}) {
    const State<6> x{0ns, JointPosition<6>::constant(0.3), JointVelocity<6>::constant(v)};
    const Quantities<Arm, FrictionControl<6>::needs> known(model, x, 0.002, none);
    const auto tau = law.torque(known), lost = friction().torque(x.dq);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(tau[i] == doctest::Approx(0.8 * lost[i]));
      CHECK(tau[i] * v >= 0);
      CHECK(std::abs(tau[i]) <= std::abs(2 * v) + 5);
    }
  }
}

TEST_CASE("FrictionControl: a share that would drive is refused") {
  CHECK_THROWS_WITH_AS(FrictionControl<6>(friction(), 1.2),
                       "skinctl: share of friction = 1.2, allowed: 0 to 1", ConfigurationError);
}
