#include "skinctl/core/time.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace skinctl;

static_assert(1s == 1000ms && 1ms == 1000us && 1us == 1000ns && 1ns == 1);
static_assert(nanoseconds(0.008) == 8ms && nanoseconds(-0.008) == -8ms);
static_assert(nanoseconds(1.4e-9) == 1 && nanoseconds(-1.6e-9) == -2);
static_assert(seconds<double>(2ms) == 0.002 && seconds<float>(500ms) == 0.5f);

TEST_CASE("nanoseconds: any double has an answer, beyond the range its end") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(nanoseconds(infinity) == INT64_MAX);
  CHECK(nanoseconds(-infinity) == INT64_MIN);
  CHECK(nanoseconds(1e300) == INT64_MAX);
  CHECK(nanoseconds(-1e300) == INT64_MIN);
  CHECK(nanoseconds(9.3e9) == INT64_MAX);
  CHECK(nanoseconds(std::numeric_limits<double>::quiet_NaN()) == 0);
  CHECK(nanoseconds(std::numeric_limits<double>::denorm_min()) == 0);
}

TEST_CASE_TEMPLATE("seconds: rounded once, and there and back within half a nanosecond of a day", T, float,
                   double) {
  for (Nanoseconds t : {0ns, 1ns, 8ms, 999'999'999ns, 86'400s, -3s, INT64_MAX, INT64_MIN}) {
    const double exact = static_cast<double>(t) / 1e9;
    const double unit = static_cast<double>(std::numeric_limits<T>::epsilon());
    CHECK(std::abs(static_cast<double>(seconds<T>(t)) - exact) <= unit * std::abs(exact));
    if (sizeof(T) == 8 && t <= 86'400s && t >= -86'400s)
      CHECK(nanoseconds(static_cast<double>(seconds<T>(t))) == t);
  }
}
