#include "skinctl/trajectory/plan_clock.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<PlanClock<>>);

TEST_CASE_TEMPLATE("PlanClock: runs with the time until it is stopped", T, float, double) {
  PlanClock<T> clock;
  for (int i = 0; i < 1000; ++i) clock = clock.advanced(2ms, 100ms);
  CHECK(clock.own == 2s);
  CHECK(clock.at(T(0.5), 100ms).t == doctest::Approx(2.5));
  CHECK(clock.at(T(0.5), 100ms).rate == T(1));
  CHECK(clock.at(T(0.5), 100ms).bend == T(0));
}

TEST_CASE("PlanClock: stops and starts smoothly, rate and bend being derivatives of own time") {
  constexpr Nanoseconds ramp = 100ms;
  const Digits50 h("1e-12");
  PlanClock<Digits50> clock;
  clock.own = 3s;
  for (const bool runs : {false, true}) {
    clock = clock.changed(runs, ramp);
    for (int i = 0; i < 30; ++i) {
      for (const Digits50& x : {Digits50("0.001"), Digits50("0.004")}) {
        const auto before = clock.at(x - h, ramp), now = clock.at(x, ramp), after = clock.at(x + h, ramp);
        CHECK(magnitude((after.t - before.t) / (2 * h) - now.rate) < Digits50("1e-18"));
        CHECK(magnitude((after.rate - before.rate) / (2 * h) - now.bend) < Digits50("1e-18"));
      }
      const auto ahead = clock.at(Digits50("0.008"), ramp);
      clock = clock.advanced(8ms, ramp);
      // own time is whole nanoseconds; the rate goes on exactly
      CHECK(magnitude(clock.at(Digits50(0), ramp).t - ahead.t) <= Digits50("0.6e-9"));
      CHECK(magnitude(clock.at(Digits50(0), ramp).rate - ahead.rate) < Digits50("1e-40"));
    }
    CHECK(clock.at(Digits50(0), ramp).rate == (runs ? 1 : 0));
  }
}

TEST_CASE("PlanClock: a stop takes half of the ramp, and a start gives it back") {
  PlanClock<double> clock;
  clock = clock.changed(false, 100ms);
  for (int i = 0; i < 200; ++i) clock = clock.advanced(1ms, 100ms);
  CHECK(seconds<double>(clock.own) == doctest::Approx(0.05).epsilon(1e-6));
  const auto stood = clock.own;
  for (int i = 0; i < 1000; ++i) clock = clock.advanced(1ms, 100ms);
  CHECK(clock.own == stood);
  clock = clock.changed(true, 100ms);
  for (int i = 0; i < 200; ++i) clock = clock.advanced(1ms, 100ms);
  CHECK(seconds<double>(clock.own - stood) == doctest::Approx(0.15).epsilon(1e-6));
}

TEST_CASE("PlanClock: a change within a change goes on from the rate it has reached") {
  PlanClock<double> clock;
  clock = clock.changed(false, 100ms);
  for (int i = 0; i < 50; ++i) clock = clock.advanced(1ms, 100ms);
  const double rate = clock.at(0, 100ms).rate;
  CHECK(rate == doctest::Approx(0.5));
  clock = clock.changed(true, 100ms);
  CHECK(clock.at(0, 100ms).rate == rate);
  for (int i = 0; i < 100; ++i) clock = clock.advanced(1ms, 100ms);
  CHECK(clock.at(0, 100ms).rate == 1.0);
}

TEST_CASE(
    "PlanClock: its pace goes over to another one, rate and bend being derivatives, and never beyond it") {
  constexpr Nanoseconds ramp = 100ms, dt = 8ms;
  const Digits50 h("1e-12"), x("0.004"), end("0.008");
  PlanClock<Digits50> clock;
  Digits50 least(1);
  for (int i = 0; i < 400; ++i) {
    const Digits50 wish = i < 50   ? Digits50("0.1")
                          : i < 60 ? Digits50("0.7")
                          : i < 63 ? Digits50("0.1")
                                   : Digits50(1);
    const auto before = clock.at(x - h, ramp), now = clock.at(x, ramp), after = clock.at(x + h, ramp);
    CHECK(magnitude((after.t - before.t) / (2 * h) - now.rate) < Digits50("1e-18"));
    CHECK(magnitude((after.rate - before.rate) / (2 * h) - now.bend) < Digits50("1e-18"));
    const auto ahead = clock.at(end, ramp);
    const auto paced = clock.advanced(dt, ramp).paced(wish, dt, ramp);
    CHECK(magnitude(paced.at(Digits50(0), ramp).rate - ahead.rate) < Digits50("1e-5"));  // snaps at the end
    CHECK(paced.pace >= Digits50("0.0999"));
    CHECK(paced.pace <= 1);
    if (i == 49) CHECK(magnitude(paced.pace - wish) < Digits50("1e-3"));
    least = paced.pace < least ? paced.pace : least;
    clock = paced;
  }
  CHECK(least < Digits50("0.11"));
  CHECK(clock.pace == 1);
  CHECK(clock.pace_rate == 0);
}

TEST_CASE("PlanClock: what stops and starts while it waits goes on with its pace") {
  constexpr Nanoseconds ramp = 100ms, dt = 8ms;
  PlanClock<double> clock;
  for (int i = 0; i < 100; ++i) clock = clock.advanced(dt, ramp).paced(0.4, dt, ramp);
  CHECK(clock.at(0, ramp).rate == doctest::Approx(0.4));
  clock = clock.changed(false, ramp);
  CHECK(clock.at(0, ramp).rate == doctest::Approx(0.4));
  for (int i = 0; i < 20; ++i) clock = clock.advanced(dt, ramp).paced(1.0, dt, ramp);
  const auto stood = clock.own;
  clock = clock.advanced(dt, ramp);
  CHECK(clock.own == stood);
  clock = clock.changed(true, ramp);
  for (int i = 0; i < 200; ++i) clock = clock.advanced(dt, ramp).paced(1.0, dt, ramp);
  CHECK(clock.at(0, ramp).rate == 1.0);
}
