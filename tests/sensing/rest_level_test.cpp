// Promise: the rest level of a cell is the same at any rate and by events
// Tried: against its equations integrated with a tiny step: seven stories of drift, contact, fall and
// release at 20 to 1000 Hz, by events, in rows of 16, float and double: within 0.5 % of the threshold at
// any instant, by events 0.6; a hundred random days: more than 1 % off for less than 0.06 % of the time.
// Also: study `rest_level`
//
// Promise: a contact of an hour from 0.05 thresholds on is not learnt away
// Tried: noise of 0.7 steps, grown within 1 s: 0.2 % of the contact at most; 1019 recorded taxels held
// for half an hour: none lost. Also: study `rest_level`
//
// Promise: a drift that was taken for a contact is released by evidence, and a cell that nothing explains
// is named
// Tried: patch, one cell, creep, 2 to 40 steps/s, nothing near: all below the threshold within 60 s;
// without evidence it stays, and is named after 60 s. Also: `sensing/evidence_test.cpp`,
// `io/skin_report_test.cpp`, study `rest_level`
//
// Promise: a rest level does not stall in float
// Tried: 12 h at 1 kHz about 60 000 steps: 5e-5 steps from double, where a plain sum does not move. Also:
// study `rest_level`

#include "skinctl/sensing/rest_level.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bench/studies/worlds/skin_drifts.hpp"
#include "skinctl/sensing/evidence.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using skinctl::testing::ReadingNoise;

namespace {

constexpr double kappa = 2, touch = 80;
constexpr RestLevels levels{float(kappa), float(touch)};
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// The rules as differential equations, by Euler's method with a tiny step.
struct Equations {
  double m, b, evidence = 0, low = 0, quiet = 0, since = 0;
  bool frozen = false, fast = false, released = false;

  void advance(double x, double seen, double h) {
    m += h * (x - m) / 0.1;
    evidence += h * (seen - evidence) / 2;
    const double r = m - b;
    if (!frozen) {
      low = r < -kappa ? low + h : 0;
      if (r > kappa)
        frozen = true, fast = released = false, since = quiet = 0;
      else if (r >= -kappa)
        b += h * r / 20;
      else if (low >= 0.5)
        b += h * r / 0.5;
      return;
    }
    since += h;
    if (fast && r < touch / 2) fast = false, since = 0;
    if (since <= 0.6 && r >= touch / 2) fast = true;
    quiet = r < kappa / 2 ? quiet + (r < -kappa ? 2 * h : h) : 0;
    const double t = since < 64 ? since : 64;
    const double L = -3 + 3 * t / (t + 32) + (fast ? -2 : 2.2) + evidence;
    released = L > (released ? 1.5 : 3.5);
    if (quiet >= 1)
      frozen = false, low = 0;
    else if (released)
      b += h * r / 5;
  }
};

/// What a cell reads and what says of a drift, over time.
struct Story {
  std::string name;
  double (*x)(double t);
  double (*evidence)(double t);
};
double none(double) {
  return 0;
}
double clear(double) {
  return 3.9;
}
double edge(double t, double at, double lasts) {
  return std::min(1.0, std::max(0.0, (t - at) / lasts));
}

const Story stories[] = {
    {"a drift, and a contact of 30 s in it",
     [](double t) { return 300 + 0.03 * t + DriftingTouch{20, 30, 100, 0.2, false, 0}.force(t); }, none},
    {"a weak contact that grows slowly",
     [](double t) { return 300 + DriftingTouch{10, 40, 8, 3, false, 0}.force(t); }, none},
    {"a rest level that falls by two thresholds", [](double t) { return 500 - 160 * edge(t, 10, 0.3); },
     none},
    {"a drift that was taken for a contact, released",
     [](double t) { return 300 + SkinDrift{SkinDrift::Kind::cell, 5, 150, 6}(t); }, clear},
    {"released, touched meanwhile, and seen",
     [](double t) {
       return 300 + SkinDrift{SkinDrift::Kind::cell, 5, 100, 10}(t) +
              DriftingTouch{25, 20, 90, 0.3, false, 0}.force(t);
     },
     [](double t) { return t > 24.7 && t < 45.3 ? -3.9 : 3.9; }},
    {"touched for a while on a rest level that is too high, twice",
     [](double t) {
       return 400 - 60 * edge(t, 12, 0.4) + DriftingTouch{5, 10, 120, 0.3, false, 0}.force(t) +
              DriftingTouch{15.4, 0.8, 50, 0.2, false, 0}.force(t);
     },
     none},
    {"a touch that leaves a drift behind it, which proximity sees",
     [](double t) {
       return 300 + SkinDrift{SkinDrift::Kind::cell, 5, 30, 2}(t) +
              DriftingTouch{4, 30, 150, 0.3, false, 0}.force(t);
     },
     [](double t) { return t > 3.7 && t < 34.3 ? -3.9 : 3.9; }},
};
constexpr double until = 80;

/// b of the equations at each millisecond.
std::vector<double> truth(const Story& story) {
  Equations e{story.x(0), story.x(0)};
  std::vector<double> b{e.b};
  const int per_ms = sanitized ? 4 : 10;
  for (int k = 1; k <= int(until * 1000); ++k) {
    for (int j = 1; j <= per_ms; ++j) {
      const double t = (k - 1 + double(j) / per_ms) / 1000;
      e.advance(story.x(t), story.evidence(t), 0.001 / per_ms);
    }
    b.push_back(e.b);
  }
  return b;
}
template <class T>
double level(const RestCell<T>& c) {
  return double(c.whole) + double(c.fraction);
}
Nanoseconds since(double t, double before) {
  return nanoseconds(t) - nanoseconds(before);
}

}  // namespace

TEST_CASE("RestLevel: the equations, within 0.6 % of the threshold, at 20 to 1000 Hz and by events") {
  RestSettings settings;
  settings.ramp = 50ms;
  const RestLevel sampled(settings), by_change;
  for (const Story& story : stories) {
    CAPTURE(story.name);
    const std::vector<double> b = truth(story);
    if (story.name == stories[6].name) CHECK(b.back() == doctest::Approx(330).epsilon(0.01));
    const auto now = [&](double t) { return b[static_cast<std::size_t>(std::lround(t * 1000))]; };
    for (const double rate : {20.0, 50.0, 100.0, 250.0, 1000.0}) {
      CAPTURE(rate);
      auto wide = sampled.start(story.x(0));
      auto one = sampled.start(float(story.x(0)));
      RestRow row;
      RestLevelsRow row_levels;
      float last[16], x[16], seen[16];
      for (std::size_t i = 0; i < 16; ++i) {
        RestLevel::put(row, i, one.cell), last[i] = one.last;
        row_levels.freeze[i] = levels.freeze, row_levels.touch[i] = levels.touch;
      }
      const auto step = sampled.step(nanoseconds(1 / rate));
      double worst = 0, before = 0;
      at_rate(rate, 0, until, [&](double t) {
        const double e = story.evidence(t);
        sampled.take(wide, story.x(t), since(t, before), e, levels);
        sampled.take(one, float(story.x(t)), since(t, before), float(e), levels);
        for (std::size_t i = 0; i < 16; ++i) x[i] = float(story.x(t)), seen[i] = float(e);
        x[3] = float(nothing);
        RestLevel::scan(row, last, x, seen, row_levels, step);
        std::copy(x, x + 16, last);
        before = t;
        worst = std::max(worst, std::abs(level(wide.cell) - now(t)));
        REQUIRE(std::abs(level(one.cell) - level(wide.cell)) < 0.02);
        REQUIRE(std::abs(level(RestLevel::cell(row, 15)) - level(one.cell)) < 0.02);
        REQUIRE(level(RestLevel::cell(row, 3)) == story.x(0));
      });
      CHECK(worst < 0.005 * touch);
    }
    auto one = by_change.start(float(story.x(0)));
    double worst = 0, before = 0;
    // What evidence is made of comes in the same samples, and sends them as well.
    const auto sent = [&](double t) { return story.x(t) + 10 * story.evidence(t); };
    by_events(sent, 1000, 1, 0.1, 0, until, [&](double t, double) {
      by_change.take(one, float(story.x(t)), since(t, before), float(story.evidence(before)), levels);
      before = t;
      worst = std::max(worst, std::abs(level(one.cell) - now(t)));
    });
    CHECK(worst < 0.006 * touch);
  }
}

namespace {

/// 16 cells at `rate`: `x(i, t)` and the evidence go in; `each(t, row)` looks.
template <class X, class Seen, class Each>
void run(const RestLevel& rest, RestRow& row, const RestLevelsRow& row_levels, double rate, double from,
         double to, X&& x, Seen&& seen, Each&& each) {
  float last[16], now[16], evidence[16];
  for (std::size_t i = 0; i < 16; ++i) last[i] = float(x(i, from));
  const auto step = rest.step(nanoseconds(1 / rate));
  at_rate(rate, from, to, [&](double t) {
    for (std::size_t i = 0; i < 16; ++i) now[i] = float(x(i, t)), evidence[i] = float(seen(i, t));
    RestLevel::scan(row, last, now, evidence, row_levels, step);
    std::copy(now, now + 16, last);
    each(t, row);
  });
}
RestLevelsRow same_levels(float freeze, float touched) {
  RestLevelsRow row;
  for (std::size_t i = 0; i < 16; ++i) row.freeze[i] = freeze, row.touch[i] = touched;
  return row;
}
RestRow at_rest(const RestLevel& rest, float b) {
  RestRow row;
  for (std::size_t i = 0; i < 16; ++i) RestLevel::put(row, i, rest.start(b).cell);
  return row;
}

}  // namespace

TEST_CASE("RestLevel: a contact of an hour, from 0.05 thresholds on, loses less than 1 %") {
  const RestLevel rest;
  const double hour = sanitized ? 300 : 3600, rate = 50, sigma = 0.7;
  const float freeze = float(rest.freeze_level(sigma, 20ms));
  RestRow row = at_rest(rest, 200);
  ReadingNoise noise(sigma, 7);
  const auto contact = [](std::size_t i) {
    return DriftingTouch{5, 7200, touch * 0.05 * std::pow(1.35, double(i)), i % 2 == 0 ? 0.01 : 0.3, true, 0};
  };
  run(
      rest, row, same_levels(freeze, float(touch)), rate, 0, hour,
      [&](std::size_t i, double t) { return noise(200 + contact(i).force(t)); },
      [](std::size_t, double) { return 0.0; }, [](double, const RestRow&) {});
  for (std::size_t i = 0; i < 16; ++i) {
    CAPTURE(i);
    CAPTURE(contact(i).size);
    const RestCell<> cell = RestLevel::cell(row, i);
    CHECK(std::abs(level(cell) - 200) < 0.01 * contact(i).size);
    CHECK(std::abs(cell.frozen) == 64);
    CHECK(is_unexplained(cell));
  }
}

TEST_CASE("RestLevel: a drift taken for a contact is released by evidence, and named without") {
  const RestLevel rest;
  RestRow row = at_rest(rest, 200);
  // Lanes 0 to 3: nothing near; 4 to 7: nothing known; 8 to 11: something near; 12 to 15: nothing near, but a
  // touch that proximity does not see, and fast.
  const auto drift = [](std::size_t i) {
    return SkinDrift{SkinDrift::Kind::cell, 5, 150, 4 + 2 * double(i % 4)};
  };
  const DriftingTouch blind{5, 600, 150, 0.2, true, 0};
  double released[16] = {};
  run(
      rest, row, same_levels(2, float(touch)), 100, 0, sanitized ? 130 : 300,
      [&](std::size_t i, double t) { return 200 + (i < 12 ? drift(i)(t) : blind.force(t)); },
      [](std::size_t i, double) {
        return double(proximity_evidence(i < 4 || i >= 12 ? 0.01 : i < 8 ? 0.2 : 0.7));
      },
      [&](double t, const RestRow& now) {
        for (std::size_t i = 0; i < 16; ++i)
          if (now.above[i] > float(touch)) released[i] = t;
      });
  for (std::size_t i = 0; i < 16; ++i) {
    CAPTURE(i);
    const RestCell<> cell = RestLevel::cell(row, i);
    if (i < 4) {
      CHECK(released[i] < 5 + 60);
      CHECK(level(cell) == doctest::Approx(350).epsilon(0.02));
      CHECK_FALSE(is_unexplained(cell));
    } else {
      CHECK(level(cell) == doctest::Approx(200).epsilon(0.002));
      CHECK(is_unexplained(cell) == (i < 8 || i >= 12));
      CHECK((cell.frozen < 0) == (i >= 12));
    }
  }
}

TEST_CASE("RestLevel: in float, at 1 kHz, b follows to less than a thousandth of a step, wherever it is") {
  const RestLevel rest;
  for (const float b : {0.f, 3.f, 1000.f, 60000.f, 1048000.f}) {
    CAPTURE(b);
    // 0.8 steps off: r falls as exp(-t/20 s) until an increment is half a unit in the last place of
    // `fraction`: r/20000 = 2^-25, r = 6e-4.
    RestRow row = at_rest(rest, b);
    double worst = 0;
    bool stalled = false;
    float plain = b;
    run(
        rest, row, same_levels(1, float(touch)), 1000, 0, sanitized ? 40 : 160,
        [&](std::size_t, double) { return b + 1; }, [](std::size_t, double) { return 0.0; },
        [&](double t, const RestRow& now) {
          if (now.frozen[0] != 0) stalled = true;
          plain += 5e-5f * (b + 1 - plain);
          // The first 0.1 s smooth the step: they delay by as much.
          if (t > 5) worst = std::max(worst, std::abs(now.above[0] - std::exp(-(t - 0.1) / 20)));
        });
    CHECK_FALSE(stalled);
    CHECK(worst < 1.3e-3);
    if (b >= 60000) CHECK(plain == b);  // one sum in float would not have moved at all
  }
}

TEST_CASE("RestLevel: whole steps are taken off, and noise does not move them to and fro") {
  const RestLevel rest;
  RestRow row = at_rest(rest, 100.5f);
  ReadingNoise noise(1, 3);
  float whole[16];
  for (std::size_t i = 0; i < 16; ++i) whole[i] = row.whole[i];
  int changes = 0;
  run(
      rest, row, same_levels(float(rest.freeze_level(1, 4ms)), float(touch)), 250, 0, sanitized ? 60 : 600,
      [&](std::size_t i, double t) { return noise(100.4 + 0.02 * double(i) + 0.0 * t); },
      [](std::size_t, double) { return 0.0; },
      [&](double, const RestRow& now) {
        for (std::size_t i = 0; i < 16; ++i) {
          REQUIRE(now.whole[i] == std::round(now.whole[i]));
          REQUIRE(std::abs(now.fraction[i]) <= 0.75f);
          if (now.whole[i] != whole[i]) ++changes;
          whole[i] = now.whole[i];
        }
      });
  CHECK(changes <= 16);
  CHECK(corrected(90.0f, RestLevel::cell(row, 0)) == 0);
  CHECK(corrected(150.0f, RestLevel::cell(row, 0)) == 150 - row.whole[0]);
}

TEST_CASE("RestLevel: readings that are none, and times that do not pass, change nothing") {
  const RestLevel rest;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  auto memory = rest.start(50.f);
  for (int k = 0; k < 100; ++k) rest.take(memory, 50.f + float(k), 4ms, 0.f, levels);
  const auto before = memory;
  for (const float x : {nan, inf, -inf, 1e7f}) rest.take(memory, x, 4ms, 0.f, levels);
  for (const Nanoseconds dt : {0ns, -1ns, Nanoseconds(-1h), Nanoseconds::min()})
    rest.take(memory, 90.f, dt, 0.f, levels);
  CHECK(memory == before);

  // Evidence that is none is none.
  auto a = before, b = before;
  for (const float e : {nan, inf, 1e9f})
    rest.take(a, 90.f, 4ms, e, levels), rest.take(b, 90.f, 4ms, 0.f, levels);
  CHECK(a == b);

  // An hour of silence counts as `max_gap`: nobody knows what was read meanwhile.
  auto hour = before, second = before;
  rest.take(hour, 50.f, 1h, 0.f, levels);
  rest.take(second, 50.f, 1s, 0.f, levels);
  CHECK(hour == second);
  rest.take(hour, 50.f, Nanoseconds::max(), 0.f, levels);
  CHECK(std::isfinite(level(hour.cell)));

  // A start that is none begins at 0; a first reading that was none does not spoil the second.
  CHECK(rest.start(nan).cell.whole == 0);
  RestRow row = at_rest(rest, 10);
  float from[16], to[16], none[16] = {};
  for (int i = 0; i < 16; ++i) from[i] = nan, to[i] = 10;
  RestLevel::scan(row, from, to, none, same_levels(1, 80), rest.step(30ms));
  for (std::size_t i = 0; i < 16; ++i) CHECK(row.above[i] == 0);
  RestLevel::scan(row, to, from, none, same_levels(1, 80), rest.step(-4ms));
  RestLevel::scan(row, to, none, none, same_levels(1, 80), rest.step(0ns));
  for (std::size_t i = 0; i < 16; ++i) CHECK(row.whole[i] == 10);
}

TEST_CASE("RestLevel: any readings at any times leave it finite, and its counters in their ranges") {
  const RestLevel rest;
  auto rng = seeded(17);
  auto memory = rest.start(100.f);
  for (int k = 0; k < (sanitized ? 20000 : 200000); ++k) {
    const float x = uniform<float>(rng, 0, 1) < 0.9f ? std::round(uniform<float>(rng, 0, 3072))
                                                     : uniform<float>(rng, -2e6f, 2e6f);
    const auto dt = Nanoseconds(static_cast<std::int64_t>(std::pow(10.0, uniform<double>(rng, 0, 9.5))));
    rest.take(memory, x, dt, uniform<float>(rng, -12, 12), levels);
    const RestCell<>& c = memory.cell;
    REQUIRE(std::isfinite(c.above));
    REQUIRE(std::abs(c.fraction) <= 0.75f);
    REQUIRE(std::abs(c.whole) <= 1048576);
    REQUIRE(std::abs(c.frozen) <= 64);
    REQUIRE((c.below >= -3 && c.below <= 2));
    REQUIRE(std::abs(c.evidence) <= 12.01f);
  }
}

TEST_CASE("RestLevel: configurations out of range are refused") {
  const auto with = [](auto change) {
    RestSettings s;
    change(s);
    return s;
  };
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.smooth = 0ns; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.smooth = 600ms; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.follow = 4s; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.max_gap = 40ms; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.max_gap = 11s; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.quiet_for = 3s; })), ConfigurationError);
  CHECK_THROWS_AS(RestLevel(with([](RestSettings& s) { s.ramp = -1ms; })), ConfigurationError);
  const RestLevel rest;
  CHECK_THROWS_AS(static_cast<void>(rest.freeze_level(std::nan(""), 4ms)), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(rest.freeze_level(1, 0ns)), ConfigurationError);
  CHECK_THROWS_AS((RestLevels{0, 80}.check()), ConfigurationError);
  CHECK_THROWS_AS((RestLevels{90, 80}.check()), ConfigurationError);
  RestLevels{1, 80}.check();
}

TEST_CASE("RestLevel: kappa is four deviations of the smoothed noise") {
  const RestLevel rest;
  for (const double rate : {20.0, 250.0, 1000.0}) {
    CAPTURE(rate);
    RestRow row = at_rest(rest, 0);
    auto rng = seeded(5);
    double sum = 0;
    int n = 0;
    run(
        rest, row, same_levels(1e4f, 1e5f), rate, 0, sanitized ? 40 : 200,
        [&](std::size_t, double) {
          double x = -6;
          for (int k = 0; k < 12; ++k) x += uniform<double>(rng, 0, 1);
          return 20 * x;
        },
        [](std::size_t, double) { return 0.0; },
        [&](double t, const RestRow& now) {
          if (t > 2)
            for (const float r : now.above) sum += double(r) * double(r), ++n;
        });
    CHECK(4 * std::sqrt(sum / n) ==
          doctest::Approx(rest.freeze_level(20, nanoseconds(1 / rate))).epsilon(0.06));
  }
}

TEST_CASE("RestLevel: a cell that is being released is not named as unexplained, nor one that is touched") {
  const auto named = [](double frozen, double below, double evidence) {
    RestCell<double> cell{};
    cell.frozen = frozen, cell.below = below, cell.evidence = evidence;
    return is_unexplained(cell);
  };
  for (const double sign : {1.0, -1.0}) {
    CHECK(named(sign * 60, 0, 0));
    CHECK_FALSE(named(sign * 59.9, 0, 0));
    CHECK_FALSE(named(sign * 60, -1, 0));
    CHECK_FALSE(named(sign * 60, 0, -1));
  }
}
