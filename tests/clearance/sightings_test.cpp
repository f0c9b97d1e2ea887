// Promise: what cells see has its place, and what is known is no sighting
// Tried: 200 poses: where it is to 1e-12 m; a ball that is known explains its own reading, one behind it
// does not; the strongest find room

#include "skinctl/clearance/sightings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;

/// A ring of cells around the forearm, and one at the upper arm.
std::vector<CellPlace> places() {
  std::vector<CellPlace> out;
  for (int k = 0; k < 12; ++k) {
    const double a = k * M_PI / 6;
    const Xyz<double> n{0, std::cos(a), std::sin(a)};
    out.push_back({2, 0, Xyz<double>{-0.2, 0, 0} + 0.05 * n, n});
  }
  out.push_back({1, 1, {-0.2, 0, 0.05}, {0, 0, 1}});
  return out;
}
}  // namespace

TEST_CASE("Sightings: a ball in front of a cell is found where it is, from all poses") {
  const Sightings<Arm> sight(Arm{}, places());
  auto rng = seeded(5);
  double worst = 0;
  for (int n = 0; n < 200; ++n) {
    JointPosition<6> q;
    for (auto& x : q) x = uniform(rng, -3.0, 3.0);
    const auto cell = static_cast<std::size_t>(n % 12);
    const auto X = link_poses(Arm{}, q).get<2>();
    const auto place = places()[cell];
    const Xyz<double> p = X.origin() + X.axes() * place.place, normal = X.axes() * place.normal;
    const double d = uniform(rng, 0.02, 0.18);
    const Xyz<double> ball = p + (d + 0.04) * normal;
    Surroundings<3> out;
    const AllocationGuard guard;
    const auto seen = sight.look(q, [&](std::size_t i) { return i == cell ? 1 - d / 0.2 : 0.0; }, out);
    const auto allocated = guard.count();
    CHECK(allocated == 0);
    REQUIRE(seen == 1);
    REQUIRE(out.count == 1);
    CHECK(out.obstacles[0].approach == 0.3);
    // Nearer by the error, along the way to the cell.
    worst = std::max(worst, std::abs(norm(Xyz<double>(out.obstacles[0].shape.from - ball)) - 0.01));
    // The same ball, known: nothing new. Known elsewhere, or behind it: still seen.
    const auto with = [&](const Xyz<double>& at) {
      Surroundings<3> known;
      known.add({{at, at, 0.04}, 0});
      return sight.look(q, [&](std::size_t i) { return i == cell ? 1 - d / 0.2 : 0.0; }, known);
    };
    CHECK(with(ball) == 0);
    CHECK(with(p - 0.3 * normal) == 1);
    CHECK(with(ball + 0.03 * normal) == 1);
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("Sightings: the strongest ones find room, weak and impossible readings are nothing") {
  const Sightings<Arm> sight(Arm{}, places());
  const JointPosition<6> q{0.3, -1.0, 1.2, 0.1, 0.2, 0.3};
  double reading[13] = {0.1, 0.5, 0.049, 0.7, std::nan(""), 0.3, 0.9, -1, 0, 0.6, 0.2, 0.05, 0.4};
  const auto read = [&](std::size_t i) { return reading[i]; };
  const auto X = link_poses(Arm{}, q).get<2>();
  Surroundings<5> out;
  out.add({{{5, 0, 0}, {5, 0, 0}, 0.1}, 0});
  CHECK(sight.look(q, read, out) == 9);
  REQUIRE(out.count == 5);
  CHECK(out.obstacles[0].shape.from.x == 5);
  for (int k = 0; k < 4; ++k) {
    const int cell[] = {6, 3, 9, 1};
    const auto place = places()[static_cast<std::size_t>(cell[k])];
    const double d = 0.2 * (1 - reading[cell[k]]) - 0.01 + 0.04;
    const Xyz<double> ball = X.origin() + X.axes() * (place.place + d * place.normal);
    CHECK(norm(Xyz<double>(out.obstacles[static_cast<std::size_t>(k) + 1].shape.from - ball)) < 1e-12);
  }
  Surroundings<1> full;
  full.add({{{5, 0, 0}, {5, 0, 0}, 0.1}, 0});
  CHECK(sight.look(q, read, full) == 9);
  CHECK(full.count == 1);
  for (auto& r : reading) r = 0;
  Surroundings<2> none;
  CHECK(sight.look(q, read, none) == 0);
  CHECK(none.count == 0);

  const auto refuses = [&](SightSettings s) {
    CHECK_THROWS_AS(Sightings<Arm>(Arm{}, places(), s), ConfigurationError);
  };
  refuses({.range = 0});
  refuses({.half_angle = 80});
  refuses({.error = -1});
  refuses({.radius = -1});
  refuses({.approach = -1});
  refuses({.min_reading = 0});
  auto other = places();
  other[0].link = 6;
  CHECK_THROWS_AS(Sightings<Arm>(Arm{}, other), ConfigurationError);
}

TEST_CASE("Sightings: the weak ones beyond the room leave what lies beside it alone") {
  const Sightings<Arm> sight(Arm{}, places());
  const JointPosition<6> q{0.3, -1.0, 1.2, 0.1, 0.2, 0.3};
  bool rising = false;  // else the strongest come first, and all later ones find no room
  const auto reading = [&](std::size_t i) {
    return rising ? 0.3 + 0.05 * double(i) : 0.9 - 0.05 * double(i);
  };
  const auto look = [&]<std::size_t Most>(std::integral_constant<std::size_t, Most>, std::uint32_t known) {
    struct {
      Surroundings<Most> room, beside;
    } memory;
    for (std::uint32_t k = 0; k < known; ++k) memory.room.add({{{5, 0, 0}, {5, 0, 0}, 0.1}, 0});
    for (auto& o : memory.beside.obstacles) o = {{{7, 0, 0}, {7, 0, 0}, 0.7}, 0.7};
    memory.beside.count = 1;
    CHECK(sight.look(q, reading, memory.room) == 13);
    CHECK(memory.room.count == Most);
    CHECK(memory.beside.count == 1);
    for (const auto& o : memory.beside.obstacles) {
      CHECK(o.shape.from.x == 7);
      CHECK(o.approach == 0.7);
    }
    for (std::uint32_t k = 0; k < known; ++k) CHECK(memory.room.obstacles[k].shape.from.x == 5);
  };
  for (const bool order : {false, true}) {
    rising = order;
    look(std::integral_constant<std::size_t, 1>{}, 0);
    look(std::integral_constant<std::size_t, 2>{}, 0);
    look(std::integral_constant<std::size_t, 2>{}, 2);
    look(std::integral_constant<std::size_t, 3>{}, 1);
  }
}

TEST_CASE("Sightings: that some obstacles are unknown stays said: nothing may come nearer") {
  const Sightings<Arm> sight(Arm{}, places());
  Surroundings<3> out;
  for (int k = 0; k < 5; ++k) out.add({{{5, 0, 0}, {5, 0, 0}, 0.1}, 0});
  for (const double reading : {0.0, 0.5}) {
    sight.look(JointPosition<6>{0.3, -1.0, 1.2, 0.1, 0.2, 0.3}, [&](std::size_t) { return reading; }, out);
    CHECK(out.count == 5);
  }
}
