// The body of the simulated hand against what statics and energy say of it.
#include "examples/simulated_allegro/plant.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "examples/adapters/allegro/cells.hpp"
#include "examples/adapters/allegro/limits.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/kinematics/poses.hpp"

using namespace simulated_allegro;

namespace {

Joints constant(double x) {
  Joints j;
  j.fill(x);
  return j;
}
double most(const Joints& a) {
  double m = 0;
  for (const double x : a) m = std::max(m, std::abs(x));
  return m;
}

}  // namespace

TEST_CASE("Plant: dry friction holds the fingers, without it they fall and come to rest at a stop") {
  PlantConfig c;
  c.coulomb = 0.05;
  Plant held(c);
  held.advance(1);
  CHECK(most(held.dq()) < 0.011);  // creeps, as friction below that speed is a damper
  PlantConfig slippery;
  slippery.coulomb = 0;
  Plant falls(slippery);
  double fastest = 0;
  for (int k = 1; k <= 1000; ++k) {
    falls.advance(0.01 * k);
    fastest = std::max(fastest, most(falls.dq()));
  }
  CHECK(fastest > 0.5);
  CHECK(most(falls.dq()) < 0.02);
  for (std::size_t i = 0; i < 16; ++i) {
    CHECK(falls.q()[i] > adapters::allegro::lower[i] - 0.08);
    CHECK(falls.q()[i] < adapters::allegro::upper[i] + 0.08);
  }
}

TEST_CASE("Plant: a torque acts after its delay, and a hand of the other side mirrors it") {
  PlantConfig right, left;
  left.side = Side::left;
  right.delay = left.delay = 0.004;
  Plant r(right), l(left);
  Joints tau = constant(0.05), mirrored = tau;
  for (const std::size_t i : {0u, 4u, 8u}) mirrored[i] = -tau[i];
  r.command(tau);
  l.command(mirrored);
  r.advance(0.0039);
  CHECK(r.torque() == Joints{});
  r.advance(0.5);
  l.advance(0.5);
  CHECK(r.torque() == tau);
  for (std::size_t i = 0; i < 16; ++i) {
    CHECK(r.q()[i] > right.start[i] + 0.01);
    const bool sideways = i < 12 && i % 4 == 0;
    CHECK(l.q()[i] == doctest::Approx(sideways ? -r.q()[i] : r.q()[i]).epsilon(0.02));
  }
}

TEST_CASE(
    "Plant: a touch moves the touched finger only, inwards, and the ball stops a finger at force over "
    "stiffness") {
  PlantConfig c;
  c.touches = {{.cell = 7, .start = 0.1, .duration = 1, .force = 1}};
  Plant touched(c), alone(PlantConfig{});
  touched.advance(0.6);
  alone.advance(0.6);
  CHECK(touched.cell_force()[7] == 1);
  for (std::size_t i = 0; i < 16; ++i) {
    const double by = touched.q()[i] - alone.q()[i];
    if (i == 5) CHECK(by < -0.05);  // pushed open
    if (i < 4 || i > 7) CHECK(std::abs(by) < 1e-9);
  }

  PlantConfig with_ball;
  with_ball.ball = Ball{};
  Plant closing(with_ball);
  Joints tau{};
  for (const std::size_t i : {5u, 6u, 7u}) tau[i] = 0.1;
  closing.command(tau);
  closing.advance(2);
  CHECK(most(closing.dq()) < 0.02);
  double on_ball = 0;
  for (const double f : closing.ball_force()) on_ball += f;
  CHECK(on_ball > 0.5);
  CHECK(on_ball < 10);
  Plant empty((PlantConfig()));
  empty.command(tau);
  empty.advance(2);
  CHECK(empty.q()[5] > closing.q()[5] + 0.1);
}

TEST_CASE(
    "Cells: on the pads of a straight hand, outward, mirrored on a left hand; numbers out of range are "
    "refused") {
  using skinctl::allegro::hand;
  for (const Side side : {Side::right, Side::left}) {
    const auto patches = adapters::allegro::skin_patches(side, 2);
    std::size_t cells = 0;
    for (const auto& p : patches) cells += p.cells.size();
    CHECK(cells == 15);
    CHECK(adapters::allegro::skin_patches(side, 2, 6, 5).front().link == 5);  // the palm on an arm
    CHECK(adapters::allegro::skin_patches(side, 2, 6, 5).front().cells.front().id == 0);
    const auto poses = skinctl::link_poses(hand(side), skinctl::JointPosition<16>());
    const auto cells_of = adapters::allegro::cell_poses(side);
    const auto in_hand =
        skinctl::Transform<skinctl::Base, skinctl::SomeLink>(poses.get<7>().axes(), poses.get<7>().origin()) *
        cells_of[7];
    // The middle finger points up the hand's z axis from (0, 0, 0.0007): 16.4, 54 and 38.4 mm, and 32.7 mm of
    // the tip.
    CHECK(in_hand.origin().z == doctest::Approx(0.0007 + 0.0164 + 0.054 + 0.0384 + 0.0327));
    CHECK(in_hand.origin().x == doctest::Approx(0.0104));
    CHECK(std::abs(in_hand.origin().y) < 1e-12);
    CHECK(in_hand.axis_z().x == doctest::Approx(std::cos(0.5236)));
    const auto index =
        skinctl::Transform<skinctl::Base, skinctl::SomeLink>(poses.get<3>().axes(), poses.get<3>().origin()) *
        cells_of[3];
    CHECK(index.origin().y * (side == Side::right ? 1 : -1) > 0.05);
  }
  PlantConfig wrong;
  wrong.touches = {{.cell = 16}};
  CHECK_THROWS_AS(Plant{wrong}, skinctl::ConfigurationError);
  wrong = {};
  wrong.rotor_inertia = 0;
  CHECK_THROWS_AS(Plant{wrong}, skinctl::ConfigurationError);
}
