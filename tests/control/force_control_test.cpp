#include "skinctl/control/force_control.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
using Touch = LinkWrenches<Arm, 0b100000>;
using Force = ForceControl<6, 5>;
using K = Quantities<Arm, Force::needs, double, Touch>;
static_assert(Law<Force, K>);
static_assert(std::is_trivially_copyable_v<Force::Memory>);
const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0.02, 0, 0.15);
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};

/// A wall of `stiffness` [N/m] and some damping in front of the tool, felt by plant and skin alike.
struct Scene {
  Force law;
  double dt, stiffness, wall;  // the wall stands at n . p = wall
  Xyz<double> n{0, 0, -1};
  State<6> x{0ns, home, {}};
  Touch touch;
  Force::Memory memory;
  Xyz<double> start;

  Scene(const ForceSettings<6>& s, double k, double gap)
      : law(X_LT, s), dt(seconds<double>(s.pose.tracking.dt)), stiffness(k) {
    memory = law.start(K(model, x, dt, touch));
    start = place();
    wall = dot(n, start) + gap;
  }
  Xyz<double> place() const { return (link_poses(model, x.q).get<5>() * X_LT).origin(); }
  double depth() const { return dot(n, place()) - wall; }
  double step() {
    const auto X = link_poses(model, x.q).get<5>();
    const double pressed = std::max(0.0, stiffness * depth());
    const Xyz<double> f_L = turn_back(X.axes(), Xyz<double>(-pressed * n));
    touch.set<5>({f_L, cross(X_LT.origin(), f_L)});
    const K known(model, x, dt, touch);
    const auto out = evaluate(law, memory, known, dt);
    memory = out.memory;
    auto tau = out.torque;
    if (law.settings().carried > 0) tau += SkinJointControl{}.torque(known);  // the wall pushes this robot
    x = simulate(model, x, tau, dt, 1);
    return pressed;
  }
};
ForceSettings<6> settings() {
  ForceSettings<6> s;
  s.pose.tracking = {.dt = 2ms, .tb = 0s};
  return s;
}
}  // namespace

TEST_CASE(
    "ForceControl: approaches, touches, and presses with the force asked for, on soft and on stiff walls") {
  for (const double stiffness : {1000.0, 3000.0, 12000.0, -3000.0}) {
    auto s = settings();
    s.carried = stiffness < 0 ? 1 : 0;
    Scene scene(s, std::abs(stiffness), 0.03);
    scene.memory =
        scene.law.receive(scene.memory, K(model, scene.x, 0.002, scene.touch), {scene.n, 15.0}).memory;
    double pressed = 0, most = 0, fastest = 0, aside = 0;
    auto last = scene.place();
    for (int i = 0; i < 4000; ++i) {
      pressed = scene.step();
      most = std::max(most, pressed);
      const auto p = scene.place();
      fastest = std::max(fastest, std::sqrt(dot(p - last, p - last)) / 0.002);
      const auto d = p - scene.start;
      const auto across = d - dot(scene.n, d) * scene.n;
      aside = std::max(aside, std::sqrt(dot(across, across)));
      last = p;
    }
    CAPTURE(stiffness);
    CHECK(pressed == doctest::Approx(15).epsilon(0.04));
    CHECK(most < 1.7 * 15);
    CHECK(fastest < 0.06);
    CHECK(aside < 2e-3);
  }
}

TEST_CASE("ForceControl: without a wall it approaches no faster and no further than allowed") {
  auto s = settings();
  s.max_travel = 0.08;
  Scene scene(s, 0, 1.0);
  scene.memory =
      scene.law.receive(scene.memory, K(model, scene.x, 0.002, scene.touch), {2.0 * scene.n, 40.0}).memory;
  for (int i = 0; i < 2500; ++i) scene.step();
  const auto d = scene.place() - scene.start;
  CHECK(dot(scene.n, d) > 0.07);
  CHECK(dot(scene.n, d) < 0.085);
  CHECK(scene.memory.I1 * s.K_i1 <= s.max_velocity);
}

TEST_CASE("ForceControl: goals in every cycle reach no further, and press as hard as one goal") {
  for (const bool wall : {false, true}) {
    CAPTURE(wall);
    auto s = settings();
    s.max_travel = 0.08;
    Scene scene(s, wall ? 3000 : 0, wall ? 0.03 : 1.0);
    double pressed = 0;
    for (int i = 0; i < 4000; ++i) {
      const double asked = wall ? 15 : 40 + 0.001 * i;  // the same goal, or one that changes each time
      const Xyz<double> n = wall ? scene.n : Xyz<double>{1e-5 * i, 0, -1};
      scene.memory =
          scene.law.receive(scene.memory, K(model, scene.x, 0.002, scene.touch), {n, asked}).memory;
      pressed = scene.step();
    }
    const auto d = scene.place() - scene.start;
    if (wall) CHECK(pressed == doctest::Approx(15).epsilon(0.04));
    CHECK(dot(scene.n, d) < 0.085);
  }
}

TEST_CASE("ForceControl: forces that cannot be are refused, and no number enters that is none") {
  Scene scene(settings(), 0, 1.0);
  const K known(model, scene.x, 0.002, scene.touch);
  const double nan = std::nan("");
  CHECK(scene.law.receive(scene.memory, known, {scene.n, -1.0}).status.has(Reason::goal_refused));
  CHECK(scene.law.receive(scene.memory, known, {{nan, 0, 0}, 1.0}).status.has(Reason::goal_refused));
  scene.memory = scene.law.receive(scene.memory, known, {scene.n, 5.0}).memory;
  Touch bad;
  bad.set<5>({{nan, 0, 0}, {}});
  const auto next = scene.law.advance(scene.memory, K(model, scene.x, 0.002, bad), 0.002, Opposition::none);
  for (const double tau : scene.law.torque(next, known)) CHECK(std::isfinite(tau));
  auto s = settings();
  s.K_p = 0;
  CHECK_THROWS_AS(Force(X_LT, s), ConfigurationError);
  s = settings();
  s.max_velocity = 2;
  CHECK_THROWS_AS(Force(X_LT, s), ConfigurationError);
}
