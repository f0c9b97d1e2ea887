#include "skinctl/control/posture.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

#include "skinctl/kinematics/jacobian_rate.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
using Posture = NullSpacePosture<6, 5>;
using KnownAt = Quantities<Arm, Posture::needs | Needs{.gravity = true, .coriolis = true}>;
static_assert(Law<Posture, KnownAt>);
const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0.05, 0, 0.15);
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};
}  // namespace

TEST_CASE("NullSpacePosture: the tool notices nothing of it, and the joints go home as far as it lets them") {
  const JointPosition<6> posture{0.3, -1.2, 1.4, -1.3, -1.1, 1.3};
  const Posture law(X_LT, posture, 4.0);
  State<6> x{0ns, home, {}};
  const auto place = [&] { return (link_poses(model, x.q).get<5>() * X_LT).origin(); };
  const auto start = place();
  const auto distance = [&] { return (as_eigen(x.q) - as_eigen(posture)).norm(); };
  const double away = distance();
  for (int i = 0; i < 1500; ++i) {
    const KnownAt known(model, x, 0.002, none);
    const auto tau = law.torque(known);
    // J M^-1 tau = 0: no acceleration of the tool.
    JointAcceleration<6> ddq;
    math::Ldlt<6>(known.mass().data).solve(tau.data, ddq.data);
    const auto a =
        known.jacobian<5>(X_LT) * JointVelocity<6>::generate([&](std::size_t k) { return ddq[k]; });
    CHECK(dot(a.linear, a.linear) < 1e-18);
    x = simulate(model, x, tau + known.gravity() + known.coriolis(), 0.002, 1);
  }
  const auto moved = place() - start;
  CHECK(std::sqrt(dot(moved, moved)) < 0.1);  // what the curvature of J adds, with nobody who corrects it
  CHECK(distance() < 0.75 * away);
}

TEST_CASE("NullSpacePosture: settings that cannot work are refused") {
  CHECK_THROWS_AS(Posture(X_LT, home, 0.0), ConfigurationError);
  CHECK_THROWS_AS(Posture(X_LT, home, 1.0, -1.0), ConfigurationError);
}
