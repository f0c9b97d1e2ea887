#include "skinctl/trajectory/gain_schedule.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// x(t) under dx = -K x, the integral of K by Simpson's rule on a fine grid between the joins.
template <class F>
double decayed(double from, double to, const F& K) {
  double sum = 0;
  const int n = 20000;
  const double h = (to - from) / n;
  for (int i = 0; i < n; ++i) {
    const double t = from + i * h;
    sum += h / 6 * (K(t) + 4 * K(t + h / 2) + K(t + h));
  }
  return std::exp(-sum);
}
}  // namespace

TEST_CASE("GainSchedule: brings an error to the closed form at tb, 0.448 of the pure time base") {
  for (const double tb : {0.2, 1.0, 8.0}) {
    const GainSchedule<> schedule(10);
    const auto& base = schedule.base();
    const auto K = [&](double t) { return schedule.at(t, tb).K; };
    const double t_p = base.peak_time() * tb;
    const double xi_rest = quintic(base.peak_time()).rest;
    const double closed = std::pow((xi_rest + base.delta()) / (1 + base.delta()), 1 + base.eps()) *
                          std::exp(-base.peak_gain() / tb * (tb - t_p));
    const double x = decayed(0, t_p, K) * decayed(t_p, tb * (1 - 1e-12), K);
    CAPTURE(tb);
    CHECK(x == doctest::Approx(closed).epsilon(1e-9));
    CHECK(x / base.remaining(1) == doctest::Approx(0.448).epsilon(2e-3));
  }
}

TEST_CASE("GainSchedule: K and dK are continuous, and dK is the derivative of K") {
  const GainSchedule<Digits50> schedule(Digits50(10), TimeBase<Digits50>(Digits50(0.05), Digits50(0.01)),
                                        Digits50(0.5));
  const Digits50 tb(2), h("1e-12");
  for (const Digits50& join :
       {Digits50(0), Digits50(tb * schedule.base().peak_time()), tb, Digits50(tb * Digits50(1.5))}) {
    const auto before = schedule.at(join - h, tb), after = schedule.at(join + h, tb);
    CHECK(magnitude(before.K - after.K) < Digits50("1e-10"));
    CHECK(magnitude(before.dK - after.dK) < Digits50("1e-8"));
  }
  Seeded rng(5);
  for (int i = 0; i < 200; ++i) {
    const Digits50 t(rng.between(0.001, 4));
    const Digits50 slope = (schedule.at(t + h, tb).K - schedule.at(t - h, tb).K) / (2 * h);
    CAPTURE(t);
    CHECK(magnitude(schedule.at(t, tb).dK - slope) < Digits50("1e-9"));
  }
  for (int i = 0; i < 200; ++i) {
    const Digits50 t(rng.between(0.001, 12));
    const Digits50 slope =
        (schedule.rising(t + h, Digits50(0.9)).K - schedule.rising(t - h, Digits50(0.9)).K) / (2 * h);
    CAPTURE(t);
    CHECK(magnitude(schedule.rising(t, Digits50(0.9)).dK - slope) < Digits50("1e-9"));
  }
}

TEST_CASE_TEMPLATE("GainSchedule: holds its peak until tb, ends at K_c, and never exceeds `largest`", T,
                   float, double) {
  const GainSchedule<T> schedule(T(9));
  const T tb = T(0.7);
  const T peak = schedule.base().peak_gain() / tb;
  CHECK(schedule.at(tb * T(0.88), tb).K == peak);
  CHECK(schedule.at(tb * T(0.999), tb).K == peak);
  CHECK(schedule.at(tb * T(0.999), tb).dK == T(0));
  CHECK(schedule.at(tb * T(1.6), tb).K == T(9));
  CHECK(schedule.at(T(1e9), tb).K == T(9));
  CHECK(schedule.at(T(-1), tb).K == T(0));
  CHECK(schedule.at(T(3), T(0)).K == T(9));
  CHECK(schedule.largest(tb) == peak);
  CHECK(schedule.largest(T(10)) == T(9));
  CHECK(schedule.largest(T(0)) == T(9));
  for (int i = 0; i < 2000; ++i) CHECK(schedule.at(T(i) * T(0.001), tb).K <= peak * (T(1) + tolerance<T>));
  CHECK(schedule.rising(T(0), T(2)).K == T(2));
  CHECK(schedule.rising(T(4), T(2)).K == T(9));
  CHECK(schedule.rising(T(0), T(20)).K == T(9));
}

TEST_CASE("GainSchedule: the shortest time keeps an error's speed below the limit, just") {
  const GainSchedule<> schedule;
  const double x0 = -0.8, limit = 1.2;
  const double tb = schedule.shortest_time(x0, limit);
  CHECK(tb == doctest::Approx(1.886 * 0.8 / 1.2).epsilon(5e-4));
  double x = x0, fastest = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double h = 2 * tb / n;
    const double mean = schedule.at((i + 0.5) * h, tb).K;
    fastest = std::max(fastest, std::abs(mean * x));
    x *= std::exp(-mean * h);
  }
  CHECK(fastest <= limit * (1 + 1e-4));
  CHECK(fastest >= limit * (1 - 1e-3));
}

TEST_CASE("GainSchedule: a rising gain keeps an error's speed within a third above its first speed") {
  for (const double ratio : {1.5, 3.0, 10.0, 50.0}) {
    const GainSchedule<> schedule(ratio);
    double x = 1, fastest = 0;
    for (int i = 0; i < 100000; ++i) {
      const double K = schedule.rising((i + 0.5) * 1e-4, 1).K;
      fastest = std::max(fastest, K * x);
      x *= std::exp(-K * 1e-4);
    }
    CAPTURE(ratio);
    CHECK(fastest <= 1.34);
  }
}

TEST_CASE("GainSchedule: refuses gains that are not positive") {
  CHECK_THROWS_AS(GainSchedule<>{0}, ConfigurationError);
  CHECK_THROWS_AS(GainSchedule<>{std::numeric_limits<double>::quiet_NaN()}, ConfigurationError);
  CHECK_THROWS_AS((GainSchedule<>{10, TimeBase<>{}, 0}), ConfigurationError);
}
