// Holding a pose costs no motion, exactly at a singularity and next to it.
//
// Promise: holding a pose costs no motion, at a singularity and 1e-9 to 0.03 rad from it
// Tried: wrist, elbow, shoulder of a UR5: 1e-6 rad of all joints together in 120 s; the tool stays within
// 0.2 mm and 1 mrad of its goal; a goal for a tool that still moves begins no rest (else a torque jumps by up
// to 5.5 N m for a cycle)

#include "skinctl/tracking/singular_rest.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/control/spline_operational.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
using L = SplineOperational<6, 5, Flange>;
using Space = OperationalSpace<6, 5, Flange>;
using K = Quantities<Arm, L::needs>;
const auto X_LF = Transform<Link<5>, Flange>::translation_xyz(0, 0, ur5::Description::d6);
using Pose = Transform<Base, Flange>;
constexpr double dt = 0.008;

Pose pose(const JointPosition<6>& q) {
  return link_poses(model, q).get<5>() * X_LF;
}
L make() {
  OperationalSettings<6> s{.tracking = {.dt = 8ms, .tb = 0s}};
  s.tracking.max_velocity = JointVelocity<6>::constant(3);
  return L(Space(X_LF, s), s);
}
enum class Kind { wrist, elbow, shoulder };
/// A pose `d` [rad] from the singularity.
JointPosition<6> next_to(Kind kind, double d) {
  using D = ur5::Description;
  JointPosition<6> q{0.3, -1.2, 1.4, -1.1, 1.2, 0.4};
  if (kind == Kind::wrist) q[4] = d;
  if (kind == Kind::elbow) q[2] = d;
  if (kind == Kind::shoulder) {  // the wrist's centre above the first axis
    const auto reach = [&](double a) {
      return D::a2 * std::cos(a) + D::a3 * std::cos(a + q[2]) + D::d5 * std::sin(a + q[2] + q[3]);
    };
    double low = -3;
    while (reach(low) * reach(low + 0.05) > 0) low += 0.05;
    double high = low + 0.05;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (reach(low) * reach(middle) <= 0 ? high : low) = middle;
    }
    q[1] = low + d;
  }
  return q;
}
struct Held {
  double way = 0;       ///< of all joints together, after 20 s [rad]
  double position = 0;  ///< of the tool in the end [m]
  double angle = 0;
};
/// Goes from `from` to the pose of `at` and stays there, in `whole` seconds.
Held hold(const JointPosition<6>& from, const JointPosition<6>& at, double whole = 120) {
  const L law = make();
  const Pose goal = pose(at);
  State<6> x{0ns, from, {}};
  auto memory = law.start(K(model, x, dt, none));
  memory = law.receive(memory, K(model, x, dt, none), {goal, 0ns}).memory;
  Held held;
  for (double t = 0; t < whole; t += dt) {
    const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
    memory = out.memory;
    x = simulate(model, x, out.torque, dt, 1);
    if (t > 20)
      for (const double u : x.dq) held.way += std::abs(u) * dt;
  }
  const auto d = pose(x.q).origin() - goal.origin();
  const auto phi = log_so3(pose(x.q).axes() * goal.axes().transpose());
  held.position = std::sqrt(dot(d, d));
  held.angle = std::sqrt(dot(phi, phi));
  return held;
}
}  // namespace

TEST_CASE("SingularRest: a goal at a singularity or next to it is reached and held without motion") {
  double most = 0;
  for (const Kind kind : {Kind::wrist, Kind::elbow, Kind::shoulder})
    for (const double d : {0.0, 1e-9, 1e-6, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
      if (sanitized && d != 1e-4) continue;
      const auto at = next_to(kind, d);
      auto from = at;
      for (std::size_t i = 0; i < 6; ++i) from[i] += i == 1 ? 0.25 : (i % 2 == 0 ? 0.3 : -0.2);
      const Held held = hold(from, at, sanitized ? 40 : (d == 1e-4 ? 120 : 40));
      CAPTURE(static_cast<int>(kind));
      CAPTURE(d);
      CHECK(held.way <= 1e-6);
      CHECK(held.position <= 2.1e-4);
      CHECK(held.angle <= 1.1e-3);
      most = std::max(most, held.way);
    }
  MESSAGE("at most " << most << " rad of all joints");
}

TEST_CASE("SingularRest: away from singularities a goal is reached to rounding") {
  const Held held = hold({0.5, -1.4, 1.6, -1.0, 0.8, 0.2}, {0.3, -1.2, 1.4, -1.1, 1.2, 0.4}, 30);
  CHECK(held.position < 1e-12);
  CHECK(held.way < 1e-9);
}

// Through a singularity at less than a millimetre a second: the arm does not take it for a goal that stands.
TEST_CASE("SingularRest: a goal that moves slowly is followed through a singularity") {
  const L law = make();
  const auto from = next_to(Kind::wrist, 0.02), to = next_to(Kind::wrist, -0.02);
  const Pose goal = pose(to);
  State<6> x{0ns, from, {}};
  auto memory = law.start(K(model, x, dt, none));
  memory = law.receive(memory, K(model, x, dt, none), {goal, 40s}).memory;  // 0.2 mm/s, 1 mrad/s
  double worst = 0;
  for (double t = 0; t < 60; t += dt) {
    const K known(model, x, dt, none);
    const auto target = memory.plan.at(0, law.settings());
    const auto d = pose(x.q).origin() - target.X_BP.origin();
    worst = std::max(worst, std::sqrt(dot(d, d)));
    const auto out = evaluate(law, memory, known, dt);
    memory = out.memory;
    x = simulate(model, x, out.torque, dt, 1);
  }
  const auto d = pose(x.q).origin() - goal.origin();
  CHECK(std::sqrt(dot(d, d)) < 2.1e-4);
  CHECK(worst < 1e-3);
}

TEST_CASE("SingularRest: begins within half the tolerance, ends beyond it, both without a jump") {
  SingularRest<6> rest;
  CHECK(rest.reached(0.24, 0));
  CHECK_FALSE(rest.reached(0.26, 0));
  CHECK_FALSE(rest.reached(0, 0.25e-6));
  CHECK_FALSE(rest.reached(std::nan(""), 0));
  const JointPosition<6> q{1, 2, 3, 4, 5, 6};
  double last = 0;
  for (int k = 0; k < 100; ++k) {
    rest = rest.advanced(true, k == 0 ? q : JointPosition<6>(), 0.002);
    CHECK(rest.r >= last);
    CHECK(rest.r - last < 0.07);
    last = rest.r;
  }
  CHECK(rest.r > 0.99);
  CHECK(rest.q == q);
  CHECK(rest.reached(0.99, 0));
  CHECK_FALSE(rest.reached(1.01, 0));
  for (int k = 0; k < 1000; ++k) {
    rest = rest.advanced(false, {}, 0.002);
    CHECK(last - rest.r < 0.07);
    last = rest.r;
  }
  CHECK(rest.r == 0);
}

TEST_CASE("SingularRest: a new goal for a tool that moves next to a singularity begins no rest") {
  const L law = make();
  double largest_step = 0;
  for (const Kind kind : {Kind::wrist, Kind::elbow, Kind::shoulder})
    for (const double d : {0.005, 0.01, 0.02, 0.04}) {
      State<6> x{0ns, next_to(kind, d), {}};
      for (double& v : x.dq) v = 0.3;
      auto memory = law.start(K(model, x, dt, none));
      memory = law.receive(memory, K(model, x, dt, none), {pose(x.q), 1s}).memory;
      auto last = law.torque(memory, K(model, x, dt, none));
      for (int k = 0; k < 6; ++k) {
        const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
        memory = out.memory;
        CHECK(memory.space.rest.r == 0);
        x = simulate(model, x, out.torque, dt, 4);
        for (std::size_t i = 0; i < 6; ++i)
          largest_step = std::max(largest_step, std::abs(out.torque[i] - last[i]));
        last = out.torque;
      }
    }
  MESSAGE("largest change of a torque in a cycle: ", largest_step, " N m");
}
