#include "skinctl/semantics/led_fingers.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Reader = LedFingersReader<3, 3>;
/// A hand of three joints and fingertips, led through postures for a test.
struct LedFingers {
  Reader reader;
  Nanoseconds t{};
  JointPosition<3> q{};
  std::array<double, 3> touch{};
  Random random = seeded(5);

  void stay(Nanoseconds time, double noise = 0) {
    for (const auto end = t + time; t < end;) {
      t += 8ms;
      Reader::Sample x{t, q, touch};
      for (std::size_t i = 0; i < 3; ++i) x.q[i] += uniform(random, -noise, noise);
      reader.take(x);
    }
  }
  void lead(const JointPosition<3>& to, Nanoseconds time) {
    const JointPosition<3> from = q;
    for (const auto begin = t, end = t + time; t < end;) {
      t += 8ms;
      const double s = std::min(1.0, seconds<double>(t - begin) / seconds<double>(time));
      for (std::size_t i = 0; i < 3; ++i) q[i] = from[i] + s * (to[i] - from[i]);
      reader.take({t, q, touch});
    }
  }
};
double off(const JointPosition<3>& a, const JointPosition<3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}
}  // namespace

TEST_CASE(
    "LedFingers: how they stood before they closed, around it with which forces, and after they let it go") {
  LedFingers hand;
  const JointPosition<3> open{0.2, 0.3, 0.1}, around{0.9, 1.0, 0.8}, wide{0.1, 0.4, 0.2};
  hand.stay(400ms);
  hand.lead(open, 700ms);
  hand.stay(300ms, 0.003);
  hand.lead(around, 500ms);
  hand.touch = {5, 0, 0.1};  // one finger alone pushes: it holds nothing
  hand.stay(300ms);
  CHECK(!hand.reader.closed());
  hand.touch = {3, 0.1, 2};
  hand.stay(40ms);
  CHECK(hand.reader.closed());
  const auto closed = hand.t;
  hand.lead({0.95, 1.05, 0.85}, 200ms);  // the person presses, and lets go
  hand.stay(500ms, 0.003);
  hand.touch = {0, 0, 0};
  hand.lead(wide, 400ms);
  CHECK(!hand.reader.closed());
  hand.stay(400ms);
  const auto taught = hand.reader.finish();
  REQUIRE(taught.size() == 2);
  CHECK(taught[0].activity == Activity::take);
  CHECK(std::abs(milliseconds(closed - taught[0].time)) <= 40);
  CHECK(off(taught[0].before, around) < 0.001);  // it stood there while one finger pushed
  CHECK(off(taught[0].q, {0.95, 1.05, 0.85}) < 0.001);
  CHECK(taught[0].force == std::array{3.0, 0.1, 2.0});
  CHECK(taught[1].activity == Activity::release);
  CHECK(taught[1].before == taught[0].q);
  CHECK(off(taught[1].q, wide) < 1e-9);
}

TEST_CASE("LedFingers: a hand that closes on the way, or never comes to a stand, teaches nothing") {
  LedFingers hand;
  hand.touch = {2, 2, 0};
  hand.stay(100ms);  // it held something when it began
  hand.touch = {0, 0, 0};
  hand.lead({1, 1, 1}, 500ms);
  hand.touch = {2, 2, 2};
  hand.lead({1.5, 1.5, 1.5}, 300ms);
  hand.touch = {0, 0, 0};
  hand.lead({0.5, 0.5, 0.5}, 300ms);
  hand.stay(100ms);
  CHECK(hand.reader.finish().empty());
}

TEST_CASE("LedFingers: samples that are none are ignored, wrong numbers refused") {
  LedFingers hand;
  hand.stay(300ms);
  const double none = std::numeric_limits<double>::quiet_NaN();
  hand.reader.take({hand.t + 1s, {none, 0, 0}, {2, 2, 2}});
  hand.reader.take({hand.t + 1s, {0, 0, 0}, {none, 2, 2}});
  hand.reader.take({hand.t, {9, 9, 9}, {2, 2, 2}});  // not later
  CHECK(!hand.reader.closed());
  hand.touch = {1, 1, 0};
  hand.stay(300ms);
  const auto taught = hand.reader.finish();
  REQUIRE(taught.size() == 1);
  CHECK(off(taught[0].before, {0, 0, 0}) == 0);
  CHECK_THROWS_AS(Reader({.holds = {0.5, 0, 0ns, 0ns}}), ConfigurationError);
  CHECK_THROWS_AS(Reader({.within = 0}), ConfigurationError);
  CHECK_THROWS_AS(Reader({.min_rest = 0ns}), ConfigurationError);
}
