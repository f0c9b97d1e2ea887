// Promise: an arm's law leaves its fingers alone
// Tried: a finger that follows its own law is as late as that law makes it (0.060 rad; 0.131 under the
// whole law)

#include "skinctl/control/on_joints.hpp"

#include <doctest/doctest.h>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/law/law.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// An arm of three joints and a finger on its last link, that the tool's position does not depend on.
struct ArmAndFinger {
  static constexpr std::size_t joints = 4;
  static constexpr auto parents = chain_parents<4>();
  static constexpr auto kinds = all_of_kind<4>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 4> links = {
      make_link({.p = {0, 0, 0.3}}, {3, {0, 0, 0.1}, 0.05, 0.05, 0.04}),
      make_link({.p = {0, 0, 0.2}, .alpha = Angle::quarter(1)}, {2, {0.2, 0, 0}, 0.01, 0.06, 0.06}),
      make_link({.p = {0.4, 0, 0}}, {1.5, {0.2, 0, 0}, 0.01, 0.05, 0.05}),
      make_link({.p = {0.35, 0, 0}}, {0.2, {0.05, 0, 0}, 1e-4, 4e-4, 4e-4})};
};
using Model = StaticModel<ArmAndFinger>;
constexpr LinkMask arm = joints_between(0, 3);
const Model model;
using Alone = SplineOperational<4, 2, Tool, double, TaskSpace::position>;
using OnArm = OnJoints<arm, Alone>;
using K = Quantities<Model, OnArm::needs | GravityControl::needs, double>;
static_assert(Law<OnArm, K> && OnArm::role == LawRole::tracking);

Alone tool_law() {
  OperationalSettings<4> s;
  s.tracking.dt = 1ms;
  s.tracking.lambda = 40;
  s.tracking.K_c = 8;
  s.tracking.tb = 2s;
  return Alone(Transform<Link<2>, Tool>::translation_xyz(0.4, 0, 0), s);
}
K known_at(const State<4>& x) {
  return K(model, x, 0.001, NoTouch{});
}
}  // namespace

TEST_CASE("OnJoints: the driven joints get the law's torque, the others their gravity and nothing else") {
  const Alone alone = tool_law();
  const auto law = on_joints<arm>(alone);
  auto random = seeded(2);
  for (int run = 0; run < 100; ++run) {
    State<4> x;
    for (double& q : x.q) q = uniform(random, -2.0, 2.0);
    for (double& v : x.dq) v = uniform(random, -2.0, 2.0);
    const auto m = law.start(known_at(x));
    for (double& v : x.dq) v += uniform(random, -0.5, 0.5);
    const auto then = known_at(x);
    const auto own = law.torque(m, then), all = alone.torque(m, then);
    for (std::size_t i = 0; i < 3; ++i) CHECK(own[i] == all[i]);
    CHECK(own[3] == then.gravity()[3]);
    CHECK(std::abs(all[3] - own[3]) > 1e-9);
    CHECK(law.torque<GravityTerm::left_out>(m, then)[3] == 0);
    CHECK(law.torque(m, then, LawShare<double>{0.5, 0.25})[3] == 0.25 * then.gravity()[3]);
  }
}

TEST_CASE("OnJoints: an arm reaches its goal, and its finger moves as a law of its own wants it") {
  double lag[2] = {0, 0};
  for (const bool whole : {false, true}) {
    const Alone alone = tool_law();
    const auto law = on_joints<arm>(alone);
    State<4> x;
    x.q = {0.2, 0.9, -1.2, 0.3};
    auto m = law.start(known_at(x));
    const auto from = law.space().where(law.space().site(known_at(x)));
    const auto goal = from.translated(0.05, 0.1, -0.05);
    m = law.receive(m, known_at(x), {goal, 1s}).memory;
    for (double t = 0; t < 5; t += 0.001) {
      const auto known = known_at(x);
      auto tau = whole ? alone.torque(m, known) : law.torque(m, known);
      const double wanted = 0.3 + std::min(t, 2.0);  // 1 rad/s
      tau[3] += 0.5 * (wanted - x.q[3]) - 0.03 * x.dq[3];
      if (t > 1.5 && t < 1.9) lag[whole] = std::max(lag[whole], wanted - x.q[3]);
      x = simulate(model, x, tau, 0.001, 1);
      m = law.advance(m, known, 0.001, Opposition::none);
    }
    CAPTURE(whole);
    const auto known = known_at(x);
    CHECK(alone.distance(known, {goal, 1s}).position < 0.001);
    CHECK(law.settled(m, known, 0.02));
    x.dq[3] = 1;  // a finger that works does not keep an arm from being settled
    CHECK(law.settled(m, known_at(x), 0.2) == true);
    CHECK(alone.settled(m, known_at(x), 0.2) == false);
  }
  MESSAGE("the finger is late by " << lag[0] << " rad, with the arm's null space on it " << lag[1]);
  CHECK(lag[0] < 0.07);
  CHECK(lag[1] > 1.5 * lag[0]);
}
