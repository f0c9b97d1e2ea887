// The core of the playground, natively: press, task, faults, refusals; cycles that allocate nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>

#include "examples/playground/tests/run.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace playground;
using skinctl::testing::sanitized;

namespace {
constexpr std::size_t forearm = 169, tool = 256;  // cells, counted from 0
}

TEST_CASE(
    "Playground: by each sense and interface it gives way, the rigid arm on the same press does not, and it "
    "goes back") {
  for (const auto& row : {std::tuple{1., 0., forearm},
                          {1., 1., forearm},
                          {1., 2., forearm},
                          {2., 0., tool},
                          {2., 1., tool},
                          {3., 0., forearm}}) {
    // The sanitizers meet each arm once; two arms of 8 ms take them as long.
    if (sanitized && row != std::tuple{1., 2., forearm} && row != std::tuple{2., 0., tool}) continue;
    const double feeling = std::get<0>(row), interface = std::get<1>(row);
    const std::size_t cell = std::get<2>(row);
    CAPTURE(feeling);
    CAPTURE(interface);
    Run r({.feeling = feeling, .interface = interface});
    r.press(cell);
    r.run(1.8);
    const View& v = r.view;
    std::printf(
        "sense %.0f, interface %.0f: %.0f N, rigid %.0f N; peaks %.0f and %.0f N; gave way by %.0f mm\n",
        feeling, interface, v.force, v.rigid_force, v.peak, v.rigid_peak, v.gave_way);
    CHECK(v.touching == 1);
    CHECK(v.force < 0.75 * v.rigid_force);
    CHECK(v.rigid_peak > 90);
    if (feeling < 3) CHECK(v.rigid_peak > 1.8 * v.peak);
    if (interface < 2) CHECK(v.rigid_gave_way < 1);  // by torque no arm is rigid
    CHECK(v.gave_way > v.rigid_gave_way + 15);
    CHECK(r.away > 0.03);
    r.arms->release();
    r.run(sanitized ? 1 : 6);
    CHECK(v.touching == 0);
    if (!sanitized) CHECK(v.away < 0.02);
    CHECK(v.ended == 0);
    if (skinctl::testing::allocations_are_counted()) CHECK(r.allocations == 0);
  }
}

TEST_CASE("Playground: rigid means the same force on both arms; the force is the finger's spring") {
  Run r({.feeling = 0});
  r.arms->finger.stiffness = 2000;
  r.arms->finger.travel = 40;
  r.press(forearm);
  r.run(1.5);
  CHECK(r.view.force == doctest::Approx(80).epsilon(0.06));  // 2000 N/m, 40 mm, a tremor of 2 %
  CHECK(r.view.rigid_force == doctest::Approx(r.view.force).epsilon(0.01));
  CHECK(r.view.gave_way < 0.5);
}

TEST_CASE("Playground: the task goes from place to place, and a press in between only delays it") {
  if (sanitized) return;  // 40 seconds of the paths that the other cases walk
  for (const bool pressed : {false, true}) {
    Run r({});
    std::array<bool, 3> been{};
    for (int k = 0; k < 200; ++k) {
      if (pressed && k == 50) r.press(forearm);
      if (pressed && k == 60) r.arms->release();
      r.run(0.1);
      const auto at = static_cast<std::size_t>(r.view.place);
      double off = 0;
      for (std::size_t i = 0; i < 6; ++i)
        off = std::max(off, std::abs(r.view.q[i] - scenario().places[at - 1][i]));
      if (r.view.resting > 0 && off < 0.02) been[at] = true;
    }
    CHECK(been[1]);
    CHECK(been[2]);
  }
}

TEST_CASE(
    "Playground: felt mass is what was asked for, at least the stable one, and a heavier arm is pressed "
    "harder") {
  Run light({}), heavy({.felt_mass = 30});
  CHECK(light.view.felt_mass == doctest::Approx(light.view.lightest));
  CHECK(heavy.view.felt_mass == doctest::Approx(30).epsilon(0.01));
  CHECK(Run({.felt_mass = 0.1}).view.felt_mass == doctest::Approx(light.view.lightest));
  for (Run* r : {&light, &heavy}) r->press(forearm), r->run(1);
  CHECK(heavy.view.peak > 1.15 * light.view.peak);
}

TEST_CASE("Playground: a lag that was not measured ends the run, in the words of the main job") {
  Run r({.real_lag = 70});
  r.press(forearm);
  r.run(3);
  CHECK(r.view.ended == 1);
  CHECK(std::string(r.arms->words()).find("stopped: the arm follows later than declared") == 0);
  r.arms->release();
  r.run(1);
  double still = 0;
  const auto q = r.view.target[0];
  r.run(1);
  still = std::abs(r.view.target[0] - q);
  CHECK(still < 1e-6);  // it holds
  Run declared({.declared_lag = 70, .real_lag = 70});
  declared.press(forearm);
  declared.run(3);
  CHECK(declared.view.ended == 0);
}

TEST_CASE(
    "Playground: dead and stuck cells do not push the arm; where they are it is numb, elsewhere it feels") {
  Run r({});
  r.press(forearm), r.run(0.2), r.arms->release(), r.run(3);
  std::array<double, 6> before{};
  std::copy_n(r.view.q, 6, before.begin());
  r.arms->hurt(true);
  r.run(2);
  CHECK(r.view.usable == 260 - Arms::dead - Arms::stuck);
  // A cell that sticks at 5 N is not followed, and on its way to a place the arm does not lead with what
  // feels nothing.
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(r.view.q[i] - before[i]) < 0.05);
  CHECK(std::string(r.arms->words())
            .find("all joints are slowed, for a place that would lead and feels badly") != std::string::npos);
  r.press(129);  // upper arm
  r.run(1.5);
  CHECK(r.view.peak < 0.7 * r.view.rigid_peak);
  r.arms->release(), r.arms->hurt(false);
  r.run(4);
  CHECK(r.view.usable >= 258);
}

TEST_CASE("Playground: what is out of range is refused with its name, and indices are held within theirs") {
  const double nan = std::nan("");
  for (const Choice& c :
       {Choice{.feeling = 4}, Choice{.feeling = nan}, Choice{.feeling = 0.5}, Choice{.interface = 1.5},
        Choice{.feeling = 2, .interface = 2}, Choice{.felt_mass = -1}, Choice{.damping = nan},
        Choice{.delay = 101}, Choice{.declared_lag = -1}, Choice{.real_lag = 1e9}})
    CHECK_THROWS_AS(make_arms(scenario(), c, scenario().places.back()), skinctl::ConfigurationError);
  Run r({});
  const double wrong[3] = {nan, 1e300, -1e300}, n[3] = {};
  r.arms->press(1000000, wrong, n);
  r.arms->finger = {.stiffness = nan, .travel = nan, .aside = {nan, nan, nan}};
  r.run(1);
  r.arms->release();
  r.arms->finger = {};
  r.run(2);
  for (const double q : r.view.q) CHECK(std::isfinite(q));
  r.press(forearm);
  r.run(1);
  CHECK(r.view.peak > 20);
}
