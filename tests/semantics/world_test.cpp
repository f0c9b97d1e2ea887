#include "skinctl/semantics/world.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Pose = ObjectPose<>;
using Hand = Transform<World, Tool>;
Pose at(double x, double y, double z) {
  return Pose::translation_xyz(x, y, z);
}
double distance(const Pose& a, const Pose& b) {
  return norm(Xyz<double>(a.origin() - b.origin()));
}
}  // namespace

TEST_CASE("ObjectWorld: detections are averaged, and an object that was moved is found after three") {
  const ObjectWorld<2> world({3, 4});
  auto m = world.start();
  CHECK((m.objects[1].kind == 4 && !m.objects[1].known));
  auto random = seeded(5);
  std::normal_distribution<double> noise(0, 0.005);
  double square = 0;
  Nanoseconds t{};
  for (int k = 0; k < 600; ++k) {
    t += 33ms;
    const auto seen =
        at(0.5 + noise(random), noise(random), 0.1 + noise(random)).rotated_z(0.05 * noise(random));
    CHECK_FALSE(world.detect(m, {.object = 0, .X_WO = seen, .sigma = 0.005, .time = t}).any());
    if (k >= 100) square += std::pow(distance(m.objects[0].X_WO, at(0.5, 0, 0.1)), 2);
  }
  const double rms = std::sqrt(square / 500 / 3);  // along one axis
  CHECK(rms < 0.0015);
  CHECK(m.objects[0].sigma == doctest::Approx(rms).epsilon(0.35));
  const auto there = at(0.8, 0.2, 0.1);
  for (int k = 1; k <= 3; ++k) {
    t += 33ms;
    static_cast<void>(world.detect(m, {.object = 0, .X_WO = there, .sigma = 0.005, .time = t}));
    CHECK((distance(m.objects[0].X_WO, there) < 0.01) == (k == 3));
  }
}

TEST_CASE(
    "ObjectWorld: what is held moves with the hand, keeps its place when released, and is missed when it "
    "slips") {
  const ObjectWorld<2> world({1, 2});
  auto m = world.start();
  static_cast<void>(world.detect(m, {.object = 0, .X_WO = at(0.5, 0, 0), .sigma = 0.005, .time = 1s}));
  const Hand X_WH = Hand::translation_xyz(0.5, 0, 0.02).rotated_z(0.3);
  world.grasp(m, 0, X_WH);
  const Hand lifted = Hand::translation_xyz(0.3, 0.4, 0.5).rotated_z(1.3);
  world.carry(m, lifted);
  const auto expected = lifted * (X_WH.inverse() * at(0.5, 0, 0));
  CHECK(distance(m.objects[0].X_WO, expected) < 1e-12);
  // Late pictures of the way do not move it; nor do two far ones.
  static_cast<void>(world.detect(m, {.object = 0, .X_WO = at(0.33, 0.35, 0.45), .sigma = 0.005, .time = 2s}));
  for (int k = 1; k <= 2; ++k)
    static_cast<void>(
        world.detect(m, {.object = 0, .X_WO = at(0.5, 0, 0), .sigma = 0.005, .time = 2s + 33ms * k}));
  CHECK(m.held == 0);
  CHECK(distance(m.objects[0].X_WO, expected) < 1e-12);
  SUBCASE("released: a picture from before the release does not count") {
    world.release(m, 3s);
    CHECK(m.held == no_object);
    CHECK(world.detect(m, {.object = 0, .X_WO = at(0, 0, 0), .sigma = 0.005, .time = 2900ms}) ==
          Status{Reason::time_backwards});
    world.carry(m, Hand{});
    CHECK(distance(m.objects[0].X_WO, expected) < 1e-12);
  }
  SUBCASE("slipped: it is where it is seen three times in a row") {
    static_cast<void>(world.detect(m, {.object = 0, .X_WO = at(0.5, 0, 0), .sigma = 0.005, .time = 2200ms}));
    CHECK((m.held == no_object && m.slipped == 0));
    CHECK(distance(m.objects[0].X_WO, at(0.5, 0, 0)) < 1e-12);
  }
}

TEST_CASE("ObjectWorld: the nearest object, and what is no detection") {
  const ObjectWorld<3> world({1, 2, 3});
  auto m = world.start();
  CHECK(world.nearest(m, {0, 0, 0}).object == no_object);
  static_cast<void>(world.detect(m, {.object = 0, .X_WO = at(1, 0, 0), .sigma = 0.01, .time = 1s}));
  static_cast<void>(world.detect(m, {.object = 2, .X_WO = at(0, 0.5, 0), .sigma = 0.01, .time = 1s}));
  CHECK(world.nearest(m, {0, 0, 0}).object == 2);
  CHECK(world.nearest(m, {0, 0, 0}).distance == doctest::Approx(0.5));
  CHECK(world.nearest(m, {0, 0, 0}, 10, 2).object == 0);
  CHECK(world.nearest(m, {0, 0, 0}, 0.4).object == no_object);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](Detection<> d, Reason why) {
    const auto before = m.objects[0].X_WO;
    CHECK(world.detect(m, d) == Status{why});
    CHECK(m.objects[0].X_WO == before);
  };
  refused({.object = 3, .X_WO = at(0, 0, 0), .sigma = 0.01, .time = 2s}, Reason::sample_unknown);
  refused({.object = 0, .X_WO = at(0, 0, 0), .sigma = 0.01, .time = 1s}, Reason::time_backwards);
  refused({.object = 0, .X_WO = at(0, nan, 0), .sigma = 0.01, .time = 2s}, Reason::sample_not_finite);
  refused({.object = 0,
           .X_WO = Pose::trusted({{nan, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}),
           .sigma = 0.01,
           .time = 2s},
          Reason::sample_not_finite);
  refused({.object = 0, .X_WO = at(0, 0, 0), .sigma = 0, .time = 2s}, Reason::sample_not_finite);
  refused({.object = 0, .X_WO = at(0, 0, 0), .sigma = 1, .time = Nanoseconds::max()},
          Reason::sample_not_finite);
  CHECK_THROWS_AS(ObjectWorld<1>({1}, {.random_walk = 0}), ConfigurationError);
  CHECK_THROWS_AS(ObjectWorld<1>({1}, {.max_misses = 0}), ConfigurationError);
}
