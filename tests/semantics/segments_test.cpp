// Recordings are cut where contact and motion change, by their own noise.
//
// Promise: segments of a recording are the same whatever its size, strength and pace: no threshold is a
// length, a force or a speed
// Tried: a way, a grip with a squeeze, and a way back; ten times as large, as strong, half as fast; noise;
// fingers that nothing measures

#include "skinctl/semantics/segments.hpp"

#include <doctest/doctest.h>

#include "skinctl/semantics/learn.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// A smooth step from 0 to 1 between `from` and `to`.
double step(double t, double from, double to) {
  const double x = std::clamp((t - from) / (to - from), 0.0, 1.0);
  return x * x * x * (10 + x * (6 * x - 15));
}

struct Shown {
  double size = 1, strength = 1, pace = 1, noise = 0;
  bool measures_opening = true;
};
/// The hand goes 0.3 m in 1 s and stands; fingers close at 2 s with 4 N and squeeze from 2.5 to 3.3 s with 8
/// N, with a stiffness of 2000 N/m; on the way back, from 4 to 5 s, they hold; they open at 5.6 s.
std::vector<ShownSample<>> recording(const Shown& s) {
  Random random = seeded(11);
  std::vector<ShownSample<>> out;
  for (int i = 0; i < 1750; ++i) {
    const double t = 0.004 * i;
    const double squeeze = step(t, 2.45, 2.55) - step(t, 3.25, 3.35);
    const double grip = step(t, 1.97, 2.03) - step(t, 5.57, 5.63), newtons = 4 * grip + 4 * squeeze;
    const double x = 0.3 * (step(t, 0.5, 1.5) - step(t, 4, 5));
    ShownSample<> at;
    at.time = nanoseconds(0.1 + t / s.pace);
    at.X_WH = Transform<World, Tool>(exp_so3(Xyz<double>{0, 0, 0}),
                                     {s.size * (x + s.noise * uniform(random, -1.0, 1.0)),
                                      s.size * s.noise * uniform(random, -1.0, 1.0), 0});
    at.force = s.strength * (newtons + 0.02 * uniform(random, -1.0, 1.0));
    if (s.measures_opening) at.opening = s.size * (0.06 - newtons / 2000);
    out.push_back(at);
  }
  return out;
}
bool near(std::size_t i, double t, double within = 0.08) {
  return std::abs(0.004 * static_cast<double>(i) - t) <= within;
}
}  // namespace

TEST_CASE(
    "Segments: contact, squeeze and ways where they are, whatever the size, the strength and the pace") {
  for (const Shown& s :
       {Shown{}, Shown{.size = 10}, Shown{.strength = 10}, Shown{.pace = 0.5},
        Shown{.size = 0.2, .strength = 0.1, .pace = 1.5}, Shown{.noise = 2e-4}, Shown{.noise = 2e-3}}) {
    CAPTURE(s.size);
    CAPTURE(s.pace);
    CAPTURE(s.noise);
    const Segments cut = segments_of(recording(s));
    REQUIRE(cut.contacts.size() == 1);
    const ShownContact& c = cut.contacts[0];
    CHECK(near(c.span.begin, 2.0));
    CHECK(near(c.span.end, 5.6));
    REQUIRE(c.squeezes.size() == 1);
    CHECK(near(c.squeezes[0].span.begin, 2.5));
    CHECK(near(c.squeezes[0].span.end, 3.3));
    CHECK(std::abs(c.squeezes[0].felt - 2000 * s.strength / s.size) < 60 * s.strength / s.size);
    for (const double t : {0.2, 1.8, 2.0, 2.9, 3.7, 5.6, 6.5}) {
      CAPTURE(t);
      CHECK(cut.moving[static_cast<std::size_t>(t / 0.004)] == 0);
    }
    for (const double t : {0.8, 1.0, 1.2, 4.3, 4.5, 4.7}) {
      CAPTURE(t);
      CHECK(cut.moving[static_cast<std::size_t>(t / 0.004)] == 1);
    }
  }
}

TEST_CASE("Segments: eight times as large and sixteen times as strong they are the same, to the sample") {
  const Shown shown{.noise = 5e-4};
  Shown larger = shown;
  larger.size = 8, larger.strength = 16;
  const Segments a = segments_of(recording(shown)), b = segments_of(recording(larger));
  CHECK(a.moving == b.moving);
  CHECK(a.smoothing == b.smoothing);
  REQUIRE(a.contacts.size() == b.contacts.size());
  const auto same = [](const Span& x, const Span& y) { return x.begin == y.begin && x.end == y.end; };
  CHECK(same(a.contacts.at(0).span, b.contacts.at(0).span));
  CHECK(same(a.contacts.at(0).squeezes.at(0).span, b.contacts.at(0).squeezes.at(0).span));
  CHECK(b.contacts.at(0).squeezes.at(0).felt == 2 * a.contacts.at(0).squeezes.at(0).felt);
}

TEST_CASE("Segments: what nothing measures is not known, what is measured now and then is") {
  auto shown = recording({.measures_opening = false});
  REQUIRE(segments_of(shown).contacts.size() == 1);
  CHECK(std::isnan(segments_of(shown).contacts[0].squeezes.at(0).felt));
  const auto whole = recording({});
  for (std::size_t i = 0; i < shown.size(); ++i)
    if (i % 3 == 0) shown[i].opening = whole[i].opening;
  CHECK(std::abs(segments_of(shown).contacts.at(0).squeezes.at(0).felt - 2000) < 60);
}

TEST_CASE("Segments: nothing, one sample, a hand that stands, and one that is never empty") {
  CHECK(segments_of(std::vector<ShownSample<>>{}).contacts.empty());
  CHECK(segments_of(std::vector<ShownSample<>>(1)).contacts.empty());
  std::vector<ShownSample<>> still(500);
  for (std::size_t i = 0; i < still.size(); ++i) still[i].time = nanoseconds(0.004 * static_cast<double>(i));
  const Segments stands = segments_of(still);
  CHECK(stands.contacts.empty());
  CHECK(std::count(stands.moving.begin(), stands.moving.end(), char(1)) == 0);
  for (auto& x : still) x.force = 3;
  REQUIRE(segments_of(still).contacts.size() == 1);
  CHECK(segments_of(still).contacts[0].squeezes.empty());
}

TEST_CASE(
    "Learning: settings out of range are refused with the number, recordings that are none with a reason") {
  std::vector<Demonstration<>> none(1);
  CHECK(learn(none).why == Refusal::not_a_recording);
  CHECK(learn(std::vector<Demonstration<>>{}).why == Refusal::not_a_recording);
  LearnSettings s;
  s.frame_ratio = 1;
  CHECK_THROWS_WITH_AS(static_cast<void>(learn(none, s)),
                       "skinctl: LearnSettings: frame_ratio = 1, allowed: >= ask_ratio, <= 1000",
                       ConfigurationError);
  s = {};
  s.deeds.use_ball = std::nan("");
  CHECK_THROWS_AS(static_cast<void>(learn(none, s)), ConfigurationError);
  // Faster than anything samples: refused, and at once.
  Demonstration<> fast;
  fast.hand = recording({});
  for (std::size_t i = 0; i < fast.hand.size(); ++i)
    fast.hand[i].time = nanoseconds(1e-6 * static_cast<double>(i));
  CHECK(learn(std::vector{fast}).why == Refusal::not_a_recording);
}
