#include "skinctl/semantics/speed_estimate.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("SpeedEstimate: noise is what it says, within 3 %, from 30 to 1000 Hz") {
  const SpeedEstimate<> estimate;
  for (const auto period : {1ms, 4ms, 10ms, 33ms}) {
    auto random = seeded(3);
    std::normal_distribution<double> noise(0, 0.001);
    SpeedEstimate<>::Memory m;
    double square = 0;
    int n = 0;
    for (int k = 0; k < 60000; ++k) {
      static_cast<void>(estimate.step(m, period * k, {noise(random), noise(random), noise(random)}));
      if (k < 1000) continue;
      square += dot(m.v, m.v);
      n += 3;
    }
    CAPTURE(period.count());
    CHECK(std::sqrt(square / n) == doctest::Approx(estimate.noise(0.001, period)).epsilon(0.03));
  }
}

TEST_CASE(
    "SpeedEstimate: exact for a constant velocity, late by `lag` for a ramp, at any rate and with jitter") {
  const SpeedEstimate<> estimate;
  for (const auto period : {1ms, 4ms, 10ms}) {
    auto random = seeded(4);
    SpeedEstimate<>::Memory even, ramp;
    Nanoseconds t{};
    while (t < 1s) {
      t += Nanoseconds(
          static_cast<std::int64_t>(uniform(random, 0.3, 1.7) * double(Nanoseconds(period).count())));
      const double s = seconds<double>(t);
      static_cast<void>(estimate.step(even, t, {2 * s, -s, 0.0}));
      static_cast<void>(estimate.step(ramp, t, {0.5 * s * s, 0.0, 0.0}));
    }
    CAPTURE(period.count());
    CHECK(even.v.x == doctest::Approx(2).epsilon(1e-6));
    CHECK(even.v.y == doctest::Approx(-1).epsilon(1e-6));
    const double late = seconds<double>(t) - ramp.v.x;  // the velocity of the ramp is the time
    CHECK(std::abs(late - seconds<double>(estimate.lag())) < seconds<double>(period));
  }
}

TEST_CASE("SpeedEstimate: begins anew after a gap, and ignores what is no sample") {
  const SpeedEstimate<> estimate;
  SpeedEstimate<>::Memory m;
  for (int k = 0; k <= 100; ++k) static_cast<void>(estimate.step(m, 4ms * k, {0.004 * k, 0.0, 0.0}));
  const auto before = m;
  CHECK(estimate.step(m, 400ms, {9.0, 0.0, 0.0}) == Status{});
  CHECK(estimate.step(m, 300ms, {9.0, 0.0, 0.0}) == Status{Reason::time_backwards});
  CHECK(estimate.step(m, 404ms, {std::numeric_limits<double>::infinity(), 0.0, 0.0}) ==
        Status{Reason::sample_not_finite});
  CHECK(m.v == before.v);
  CHECK(m.time == before.time);
  static_cast<void>(estimate.step(m, 700ms, {5.0, 0.0, 0.0}));
  CHECK(m.v.x == 0);
  CHECK(estimate.noise(0.001, 0ns) == std::numeric_limits<double>::infinity());
  CHECK_THROWS_AS(SpeedEstimate<>({.time_constant = 0ns}), ConfigurationError);
  CHECK_THROWS_AS(SpeedEstimate<>({.time_constant = 20ms, .max_gap = 10ms}), ConfigurationError);
}
