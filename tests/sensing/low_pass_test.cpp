// Promise: filters do not care about the rate: first order exact for linear pieces and for events, at any
// ratio of step and time constant
// Tried: float and double against 50 digits (4 units in the last place), closed forms; NaN, denormals,
// steps of 1 ns to 584 years

#include "skinctl/sensing/low_pass.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<LowPass<>::Memory>);

namespace {
/// The output after a linear piece, from the solution `y = x - tau s + C exp(-t / tau)`.
Digits50 solved(const Digits50& y, const Digits50& x0, const Digits50& x1, Nanoseconds dt, Nanoseconds tau) {
  const Digits50 t = Digits50(dt.count()), T = Digits50(tau.count()), slope = (x1 - x0) / t;
  return x1 - T * slope + (y - x0 + T * slope) * exp(-t / T);
}
}  // namespace

TEST_CASE_TEMPLATE("LowPass: one step is exact at any ratio of step and time constant", T, float, double) {
  auto random = seeded(1);
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const Nanoseconds tau = nanoseconds(std::pow(10.0, uniform(random, -6.0, 2.9)));
    const Nanoseconds dt(static_cast<std::int64_t>(std::pow(10.0, uniform(random, 0.0, 18.0))));
    const LowPass<T> filter(tau);
    typename LowPass<T>::Memory m{5s, static_cast<T>(uniform(random, -1.0, 1.0)),
                                  static_cast<T>(uniform(random, -1.0, 1.0)), true};
    const auto x1 = static_cast<T>(uniform(random, -1.0, 1.0));
    const Digits50 expected = solved(m.output, m.input, x1, dt, tau);
    CHECK_FALSE(filter.sample(m, 5s + dt, x1).any());
    worst = std::max(worst, static_cast<double>(abs(Digits50(m.output) - expected)));
    CHECK(m.input == x1);
  }
  CHECK(worst <= 4 * double(epsilon<T>()));
}

TEST_CASE_TEMPLATE("LowPass: the same at any rate, regular or not", T, float, double) {
  const LowPass<T> filter(50ms);
  auto random = seeded(2);
  // A polygon with corners each 20 ms, sampled at the corners, and at other times as well.
  typename LowPass<T>::Memory corners, many;
  T last = 0;
  for (int k = 0; k < 500; ++k) {
    const auto next = static_cast<T>(uniform(random, -1.0, 1.0));
    for (Nanoseconds t = 100us; t < 20ms && k > 0; t += nanoseconds(uniform(random, 1e-6, 5e-3)))
      static_cast<void>(
          filter.sample(many, k * 20ms + t - 20ms, last + (next - last) * seconds<T>(t) / T(0.02)));
    static_cast<void>(filter.sample(many, k * 20ms, next));
    static_cast<void>(filter.sample(corners, k * 20ms, next));
    last = next;
    CHECK(std::abs(double(many.output - corners.output)) <= 200 * double(epsilon<T>()));
  }
}

TEST_CASE("LowPass: an event was held, and is linear over the ramp") {
  const LowPass<> filter(30ms, 6ms);
  LowPass<>::Memory events, samples;
  static_cast<void>(filter.event(events, 0ns, 0.2));
  static_cast<void>(filter.sample(samples, 0ns, 0.2));
  static_cast<void>(filter.sample(samples, 74ms, 0.2));
  static_cast<void>(filter.sample(samples, 80ms, 0.9));
  static_cast<void>(filter.event(events, 80ms, 0.9));
  CHECK(events.output == doctest::Approx(samples.output).epsilon(1e-15));
  static_cast<void>(filter.sample(samples, 84ms, 0.1));
  static_cast<void>(filter.event(events, 84ms, 0.1));  // nearer than the ramp: linear since the last one
  CHECK(events.output == doctest::Approx(samples.output).epsilon(1e-15));
  CHECK(filter.value(events, 84ms) == events.output);
  CHECK(filter.value(events, 114ms) == doctest::Approx(0.1 + (events.output - 0.1) * std::exp(-1.0)));
}

TEST_CASE_TEMPLATE("LowPass: extremes, and what it refuses", T, float, double) {
  const LowPass<T> filter(10ms);
  typename LowPass<T>::Memory m;
  const T nan = std::numeric_limits<T>::quiet_NaN(), tiny = std::numeric_limits<T>::denorm_min();
  CHECK(filter.sample(m, 0ns, nan) == Status(Reason::sample_not_finite));
  CHECK_FALSE(m.started);
  CHECK_FALSE(filter.sample(m, Nanoseconds::min(), T(1)).any());
  CHECK(m.output == T(1));
  CHECK_FALSE(
      filter.sample(m, Nanoseconds::max(), T(2)).any());  // 584 years: the end of a ramp, tau behind it
  CHECK(double(m.output) == doctest::Approx(2).epsilon(1e-12));
  CHECK(filter.sample(m, Nanoseconds::max(), T(3)) == Status(Reason::time_backwards));
  CHECK(filter.event(m, 0ns, std::numeric_limits<T>::infinity()) == Status(Reason::sample_not_finite));
  CHECK(double(m.output) == doctest::Approx(2).epsilon(1e-12));
  m = {0ns, tiny, tiny, true};
  CHECK_FALSE(filter.sample(m, 1ns, T(2) * tiny).any());
  CHECK(m.output >= tiny);
  CHECK(m.output <= T(2) * tiny);
  // A nanosecond against a thousand seconds moves nothing, and nothing wrong.
  const LowPass<T> slow(1000s);
  m = {0ns, T(0), T(0), true};
  CHECK_FALSE(slow.sample(m, 1ns, T(1)).any());
  CHECK(double(m.output) == doctest::Approx(0.5e-12).epsilon(1e-6));
  CHECK_THROWS_AS(LowPass<T>(0ns), ConfigurationError);
  CHECK_THROWS_AS(LowPass<T>(2000s), ConfigurationError);
  CHECK_THROWS_AS(LowPass<T>(1s, -1ns), ConfigurationError);
}
