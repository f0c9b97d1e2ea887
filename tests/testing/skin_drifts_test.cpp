// by night: a world of studies
#include "bench/studies/worlds/skin_drifts.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace skinctl::testing;

TEST_CASE("Drifts begin at 0, at their rates, and keep to their size") {
  using Kind = SkinDrift::Kind;
  Seeded rng(3);
  for (const Kind kind : {Kind::patch, Kind::cell, Kind::creep, Kind::discharge})
    for (int k = 0; k < 200; ++k) {
      const SkinDrift drift = random_drift(rng, kind, 80, 5);
      CHECK(drift(5) == 0);
      CHECK(drift.size >= 0.3 * 80);
      CHECK(drift.size <= 4 * 80);
      double most = 0;
      for (double t = 0; t < 1000; t += 0.5) most = std::max(most, drift(t));
      CHECK(most <= drift.size);
      if (kind == Kind::discharge) {
        CHECK(drift(5.005) > 0.99 * drift.size);
        CHECK(drift(5.005 + drift.size / drift.rate) ==
              doctest::Approx(drift.size * std::exp(-1)).epsilon(0.01));
      } else {
        CHECK(drift.rate >= 2);
        CHECK(drift.rate <= 40);
        CHECK((drift(5.001) - drift(5)) * 1000 == doctest::Approx(drift.rate).epsilon(0.01));
        CHECK(most > 0.99 * drift.size);
      }
    }
}

TEST_CASE("A contact is seen before it is felt, unless it is blind, and warms") {
  const DriftingTouch contact{10, 3600, 50, 0.5, false, 6};
  CHECK(contact.force(10) == 0);
  CHECK(contact.force(10.25) == doctest::Approx(25));
  CHECK(contact.force(1800) == 50);
  CHECK(contact.force(3610) == 0);
  CHECK(contact.proximity(9.7) < 0.05);
  CHECK(contact.proximity(10) == doctest::Approx(0.8));
  CHECK(contact.proximity(3000) == doctest::Approx(0.8));
  CHECK(contact.warming(10) == 0);
  CHECK(contact.warming(70) == doctest::Approx(6 * (1 - std::exp(-1))));
  CHECK(contact.warming(3670) == doctest::Approx(6 * std::exp(-1)));
  DriftingTouch blind = contact;
  blind.blind = true;
  for (double t = 0; t < 4000; t += 0.37) REQUIRE(blind.proximity(t) < 0.05);
  CHECK(tap(1, 300).force(1.003) == 300);
  CHECK(tap(1, 300).force(1.006) == 0);

  Seeded rng(9);
  int unseen = 0, slow = 0, warm = 0;
  for (int k = 0; k < 4000; ++k) {
    const DriftingTouch c = random_contact(rng, 0, 3600, 80, 400);
    unseen += c.blind, slow += c.rise >= 5, warm += c.warmth > 0;
    REQUIRE(c.size >= 80);
    REQUIRE(c.size <= 400);
  }
  CHECK(std::abs(unseen - 80) < 35);
  CHECK(std::abs(slow - 600) < 100);
  CHECK(std::abs(warm - 1200) < 130);
}

TEST_CASE("Noise has its deviation, whole steps and no negative readings") {
  ReadingNoise noise(3, 5);
  double sum = 0, square = 0;
  const int n = 40000;
  for (int k = 0; k < n; ++k) {
    const double x = noise(100);
    REQUIRE(x == std::round(x));
    sum += x - 100, square += (x - 100) * (x - 100);
    REQUIRE(noise(0) >= 0);
  }
  CHECK(std::abs(sum / n) < 0.06);
  CHECK(std::sqrt(square / n) == doctest::Approx(std::sqrt(9 + 1.0 / 12)).epsilon(0.02));
}

TEST_CASE("Events: what is held is right to within a delta and a keep-alive old") {
  const DriftingTouch contact{2, 3, 60, 0.4, false, 0};
  std::vector<double> times;
  double held = 0, sent = 0;
  by_events([&](double t) { return contact.force(t); }, 1000, 2, 0.1, 0, 8,
            [&](double t, double x) {
              if (!times.empty()) {
                CHECK(t - times.back() < 0.1001);
                for (double between = times.back() + 0.001; between < t - 0.0005; between += 0.001)
                  REQUIRE(std::abs(contact.force(between) - held) < 2);
              }
              times.push_back(t), held = x, ++sent;
            });
  CHECK(sent < 170);
  CHECK(sent > 80);
  int n = 0;
  at_rate(250, 1, 3, [&](double t) { n += t > 1 && t <= 3; });
  CHECK(n == 500);
}
