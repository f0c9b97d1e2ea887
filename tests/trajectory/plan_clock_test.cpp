#include "skinctl/trajectory/plan_clock.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "exact.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<PlanClock<>>);

TEST_CASE_TEMPLATE("PlanClock: runs with the time until it is stopped", T, float, double) {
  PlanClock<T> clock;
  for (int i = 0; i < 1000; ++i) clock = clock.advanced(2ms, T(0.1));
  CHECK(clock.own == 2s);
  CHECK(clock.at(T(0.5), T(0.1)).t == doctest::Approx(2.5));
  CHECK(clock.at(T(0.5), T(0.1)).rate == T(1));
  CHECK(clock.at(T(0.5), T(0.1)).bend == T(0));
}

TEST_CASE("PlanClock: stops and starts smoothly, rate and bend being derivatives of own time") {
  const Exact ramp("0.1"), h("1e-12");
  PlanClock<Exact> clock;
  clock.own = 3s;
  for (const bool runs : {false, true}) {
    clock = clock.changed(runs, ramp);
    for (int i = 0; i < 30; ++i) {
      for (const Exact& x : {Exact("0.001"), Exact("0.004")}) {
        const auto before = clock.at(x - h, ramp), now = clock.at(x, ramp), after = clock.at(x + h, ramp);
        CHECK(magnitude((after.t - before.t) / (2 * h) - now.rate) < Exact("1e-18"));
        CHECK(magnitude((after.rate - before.rate) / (2 * h) - now.bend) < Exact("1e-18"));
      }
      const auto ahead = clock.at(Exact("0.008"), ramp);
      clock = clock.advanced(8ms, ramp);
      // own time is whole nanoseconds; the rate goes on exactly
      CHECK(magnitude(clock.at(Exact(0), ramp).t - ahead.t) <= Exact("0.6e-9"));
      CHECK(magnitude(clock.at(Exact(0), ramp).rate - ahead.rate) < Exact("1e-40"));
    }
    CHECK(clock.at(Exact(0), ramp).rate == (runs ? 1 : 0));
  }
}

TEST_CASE("PlanClock: a stop takes half of the ramp, and a start gives it back") {
  PlanClock<double> clock;
  clock = clock.changed(false, 0.1);
  for (int i = 0; i < 200; ++i) clock = clock.advanced(1ms, 0.1);
  CHECK(clock.own == doctest::Approx(50e6).epsilon(1e-6));
  const auto stood = clock.own;
  for (int i = 0; i < 1000; ++i) clock = clock.advanced(1ms, 0.1);
  CHECK(clock.own == stood);
  clock = clock.changed(true, 0.1);
  for (int i = 0; i < 200; ++i) clock = clock.advanced(1ms, 0.1);
  CHECK(clock.own - stood == doctest::Approx(150e6).epsilon(1e-6));
}

TEST_CASE("PlanClock: a change within a change goes on from the rate it has reached") {
  PlanClock<double> clock;
  clock = clock.changed(false, 0.1);
  for (int i = 0; i < 50; ++i) clock = clock.advanced(1ms, 0.1);
  const double rate = clock.at(0, 0.1).rate;
  CHECK(rate == doctest::Approx(0.5));
  clock = clock.changed(true, 0.1);
  CHECK(clock.at(0, 0.1).rate == rate);
  for (int i = 0; i < 100; ++i) clock = clock.advanced(1ms, 0.1);
  CHECK(clock.at(0, 0.1).rate == 1.0);
}
