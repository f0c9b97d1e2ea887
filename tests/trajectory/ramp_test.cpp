#include "skinctl/trajectory/ramp.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("Ramp: goes from 0 to 1 without a jump in value, rate or bend", T, float, double) {
  const Ramp<T> ramp(200ms);
  CHECK(ramp.up(-1s) == T(0));
  CHECK(ramp.up(0ns) == T(0));
  CHECK(ramp.up(200ms) == T(1));
  CHECK(ramp.up(clock_end) == T(1));
  CHECK(ramp.lasts(199ms));
  CHECK_FALSE(ramp.lasts(200ms));
  T last(0);
  for (Nanoseconds t{}; t <= 200ms; t += 100us) {
    const T w = ramp.up(t);
    CHECK(w >= last);
    CHECK(w - last <= T(1.875 * 0.1 / 200 * 1.001));
    CHECK(magnitude(T(w + ramp.down(t) - T(1))) <= epsilon<T>());
    last = w;
  }
}

TEST_CASE_TEMPLATE("Ramp: a blend meets both ends exactly", T, float, double) {
  const T a = T(0.1), b = T(1e6);
  CHECK(blend(a, b, T(0)) == a);
  CHECK(blend(a, b, T(1)) == b);
}

TEST_CASE("Ramp: clocks stop at their end instead of overflowing") {
  CHECK(later(0ns, 5ns) == 5ns);
  CHECK(later(clock_end, 1s) == clock_end);
  CHECK(later(clock_end - 1ns, Nanoseconds::max() / 2) == clock_end);
}

TEST_CASE("Ramp: refuses a duration that is not positive") {
  CHECK_THROWS_AS(Ramp<>(0ns), ConfigurationError);
  CHECK_THROWS_WITH_AS(Ramp<>(-1ms), "skinctl: duration of a ramp = -0.001, allowed: > 0 s",
                       ConfigurationError);
}
