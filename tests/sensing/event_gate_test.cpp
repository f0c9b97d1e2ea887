#include "skinctl/sensing/event_gate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace skinctl;

TEST_CASE_TEMPLATE("EventGate: a dead band gives 0 below, what exceeds above, and no step between", T, float,
                   double) {
  const auto gate = EventGate<T>::dead_band(T(0.08));
  CHECK(gate.pass(T(0), false) == T(0));
  CHECK(gate.pass(T(0.08), false) == T(0));
  CHECK(gate.pass(T(0.5), false) == T(0.5) - T(0.08));
  T before = 0;
  bool open = false;
  for (int k = 0; k <= 100000; ++k) {
    const T x = T(k) / T(100000);
    const T y = gate.pass(x, open);
    REQUIRE(y == gate.pass(x, !open));  // no hysteresis
    REQUIRE(y >= before);
    REQUIRE(y - before <= T(1.1e-5));
    before = y, open = y > 0;
  }
}

TEST_CASE_TEMPLATE("EventGate: hysteresis opens at one reading and closes below another", T, float, double) {
  const auto gate = EventGate<T>::hysteresis(T(0.1), T(0.06));
  CHECK(gate.pass(T(0.09), false) == T(0));
  CHECK(gate.pass(T(0.1), false) == T(0.1));
  CHECK(gate.pass(T(0.09), true) == T(0.09));
  CHECK(gate.pass(T(0.06), true) == T(0.06));
  CHECK(gate.pass(T(0.0599), true) == T(0));
  // Noise of less than the hysteresis about either threshold opens or closes it once.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> noise(-0.015, 0.015);
  for (const T level : {T(0.1), T(0.06)}) {
    int changes = 0;
    bool open = level == T(0.06);
    for (int k = 0; k < 10000; ++k) {
      const bool now = gate.pass(level + T(noise(random)), open) > T(0);
      changes += now != open;
      open = now;
    }
    CHECK(changes == 1);
  }
}

TEST_CASE("EventGate: a contact held for a day reads the same at its end") {
  const auto gate = EventGate<>::dead_band(0.08);
  const double first = gate.pass(0.3, false);
  bool same = true;
  for (long k = 0; k < 24L * 3600 * 250; ++k) same = same && gate.pass(0.3, true) == first;
  CHECK(same);
}

TEST_CASE("EventGate: not a number closes it; infinity does not become one") {
  const auto gate = EventGate<>::hysteresis(0.1, 0.05);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(gate.pass(nan, true) == 0);
  CHECK(gate.pass(nan, false) == 0);
  CHECK(gate.pass(-std::numeric_limits<double>::infinity(), true) == 0);
}

TEST_CASE("EventGate: on counts it is the same gate to within half a step") {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> reading(0, 1);
  const double unit = 1.0 / 16384;
  for (int n = 0; n < 200; ++n) {
    double a = reading(random), b = reading(random), c = reading(random);
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    const EventGate<> gate(a, b, c);
    const auto counted = gate.counted(unit);
    CHECK(std::abs(counted.opens_at() * unit - a) <= 0.5 * unit);
    CHECK(std::abs(counted.closes_below() * unit - b) <= 0.5 * unit);
    CHECK(std::abs(counted.subtract() * unit - c) <= 0.5 * unit);
    for (int k = 0; k < 100; ++k) {
      const int x = static_cast<int>(random() % 16385);
      const bool open = random() % 2;
      const double edge = open ? b : a;
      if (std::abs(x * unit - edge) <= unit || std::abs(x * unit - c) <= unit) continue;
      CHECK(std::abs(counted.pass(x, open) * unit - gate.pass(x * unit, open)) <= 0.51 * unit);
    }
  }
}

TEST_CASE("EventGate: thresholds in the wrong order are refused with their number") {
  CHECK_THROWS_WITH_AS(EventGate<>(0.1, 0.2, 0.0),
                       "skinctl: EventGate: opens_at = 0.1, allowed: >= closes_below", ConfigurationError);
  CHECK_THROWS_AS(EventGate<>(0.2, 0.1, 0.15), ConfigurationError);
  CHECK_THROWS_AS(EventGate<>(0.2, 0.1, -0.1), ConfigurationError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(EventGate<>(nan, 0.1, 0.0), ConfigurationError);
  CHECK_THROWS_AS(EventGate<>(0.2, nan, 0.0), ConfigurationError);
  CHECK_THROWS_AS(EventGate<>(std::numeric_limits<double>::infinity(), 0.1, 0.0), ConfigurationError);
  CHECK_THROWS_AS((void)EventGate<>::dead_band(1e9).counted(1e-9), ConfigurationError);
}
