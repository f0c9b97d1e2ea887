#include "skinctl/testing/hand.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace skinctl::testing;

namespace {

constexpr double h = 1e-4, pi = 3.14159265358979323846;

/// Steps until time `t`; `at(t)` is where the robot stands.
template <class Plant, class Robot>
double run(Plant& hand, double& now, double until, double goal, Robot&& at) {
  double force = 0;
  for (; now < until - 0.5 * h; now += h) force = hand.advance(h, goal, at(now + h));
  return force;
}
double far(double) {
  return 1e3;
}

/// Of mass, springs and dampers, against a wall at 0.
double energy(const Hand& hand, double goal, double robot) {
  const auto& s = hand.settings();
  const double squeezed = hand.x() - robot, stretched = goal - hand.x();
  return 0.5 * s.mass * hand.v() * hand.v() + 0.5 * s.stiffness * stretched * stretched +
         (squeezed > 0 || s.holds ? 0.5 * s.cover_stiffness * squeezed * squeezed : 0.0);
}

}  // namespace

TEST_CASE("Hand: led through the air it answers as mass, spring and damper do") {
  for (const double mass : {2.0, 5.0, 10.0})
    for (const double stiffness : {100.0, 300.0, 2000.0}) {
      CAPTURE(mass);
      CAPTURE(stiffness);
      const HandSettings s{.mass = mass, .stiffness = stiffness, .damping = 20};
      Hand hand(s);
      const double a = s.damping / (2 * mass), w = std::sqrt(stiffness / mass - a * a);
      double now = 0;
      for (double t = 0.05; t < 2; t += 0.05) {
        CHECK(run(hand, now, t, 0.1, far) == 0);
        const double closed =
            0.1 * (1 - std::exp(-a * now) * (std::cos(w * now) + a / w * std::sin(w * now)));
        CHECK(hand.x() == doctest::Approx(closed).epsilon(1e-4));
      }
    }
}

TEST_CASE("Hand: on a robot that stands it rests with the force of both springs in series") {
  const HandSettings s{.mass = 5, .stiffness = 300, .damping = 100, .push = 2, .cover_damping = 100};
  Hand hand(s);
  double now = 0;
  const double force = run(hand, now, 4, 0.1, [](double) { return 0.0; });
  const double k = s.cover_stiffness;
  CHECK(force == doctest::Approx(k * (300 * 0.1 + 2) / (k + 300)).epsilon(1e-9));
}

TEST_CASE(
    "Hand: without dampers it swings for ever, with the frequency of both springs, and keeps its energy") {
  const HandSettings s{
      .mass = 2, .stiffness = 500, .damping = 0, .cover_stiffness = 3000, .cover_damping = 0, .holds = true};
  Hand hand(s, 0.01);
  double now = 0;
  const double before = energy(hand, 0, 0), w = std::sqrt(3500.0 / 2);
  for (double t = 0.01; t < 1; t += 0.01) {
    run(hand, now, t, 0, [](double) { return 0.0; });
    CHECK(energy(hand, 0, 0) == doctest::Approx(before).epsilon(1e-9));
    CHECK(std::abs(hand.x() - 0.01 * std::cos(w * now)) < 0.01 * 1e-3);
  }
}

TEST_CASE("Hand: a robot that moves gives it the energy that it gains; damping only takes") {
  for (const double damping : {0.0, 30.0}) {
    HandSettings s{.mass = 5, .stiffness = 300, .damping = damping, .cover_damping = damping, .holds = true};
    Hand hand(s);
    double given = 0, robot = 0;
    for (double now = 0; now < 2; now += h) {
      const double next = 0.01 * (1 - std::cos(2 * pi * 3 * (now + h)));
      given -= hand.advance(h, 0, next) * (next - robot);
      robot = next;
      // The first step only tells it where the robot is.
      const double gained = energy(hand, 0, robot);
      if (damping == 0)
        CHECK(std::abs(gained - given) < 1e-6);
      else
        CHECK(gained <= given + 1e-6);
    }
    CHECK(given > 1e-3);
  }
}

TEST_CASE("Hand: never pulls unless it holds") {
  for (const bool holds : {false, true}) {
    HandSettings s = leading_hand();
    s.holds = holds;
    Hand hand(s);
    double least = 0;
    for (double now = 0; now < 1; now += h)
      least = std::min(least, hand.advance(h, 0, 0.02 * std::sin(2 * pi * 2 * now)));
    CHECK((least < -1) == holds);
  }
}

TEST_CASE("Hand: a tremor moves it as its mass and spring let it") {
  const HandSettings s{.mass = 2, .stiffness = 100, .damping = 30, .tremor = 0.3, .tremor_frequency = 8};
  Hand hand(s);
  double now = 0, high = 0;
  run(hand, now, 3, 0, far);
  for (; now < 4; now += h) {
    hand.advance(h, 0, 1e3);
    high = std::max(high, hand.x());
  }
  const double w = 2 * pi * 8;
  CHECK(high == doctest::Approx(0.3 / std::hypot(100 - 2 * w * w, 30 * w)).epsilon(1e-3));
}

TEST_CASE("Hand: an infinite mass is a wall, still or led") {
  Hand wall(stiff_wall(1e5), -0.01);
  double now = 0;
  CHECK(run(wall, now, 0.1, -0.01, [](double) { return 0.0; }) == 0);
  CHECK(run(wall, now, 0.2, 0.001, [](double) { return 0.0; }) == doctest::Approx(100));
}

TEST_CASE("Hand: body and finger press with what they are told") {
  Hand body(leaning_body(50), 0.0);
  double now = 0;
  CHECK(run(body, now, 10, 0, [](double) { return 0.0; }) == doctest::Approx(50).epsilon(1e-6));
  Hand finger(poking_finger(), 0.0);
  now = 0;
  CHECK(run(finger, now, 5, 0.01, [](double) { return 0.0; }) == doctest::Approx(7.5).epsilon(1e-6));
}

TEST_CASE("Grip: at rest both hands press, the robot feels none of it; it is as stiff as both together") {
  Grip grip(leading_hand(), 30);
  double now = 0;
  CHECK(std::abs(run(grip, now, 0.5, 0, [](double) { return 0.0; })) < 1e-9);
  for (const unsigned i : {0u, 1u}) CHECK(grip.hand(i).force() == doctest::Approx(30).epsilon(1e-9));
  const double force = run(grip, now, 6, 0, [](double) { return 0.001; });
  CHECK(force == doctest::Approx(-0.001 * 2 * (1e4 * 300 / (1e4 + 300))).epsilon(1e-6));
  // Pulled out of the covers: one hand alone.
  run(grip, now, 6.001, 0, [](double) { return 0.02; });
  CHECK(grip.hand(0).force() == 0);
}
