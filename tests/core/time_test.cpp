#include "skinctl/core/time.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

using namespace skinctl;

static_assert(1s == 1000ms && 1ms == 1000us && 1us == 1000ns);
static_assert(nanoseconds(0.008) == 8ms && nanoseconds(-0.008) == -8ms);
static_assert(nanoseconds(1.4e-9) == 1ns && nanoseconds(-1.6e-9) == -2ns);
static_assert(seconds<double>(2ms) == 0.002 && seconds<float>(500ms) == 0.5f);

TEST_CASE("nanoseconds: any double has an answer, beyond the range its end") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(nanoseconds(infinity) == Nanoseconds::max());
  CHECK(nanoseconds(-infinity) == Nanoseconds::min());
  CHECK(nanoseconds(1e300) == Nanoseconds::max());
  CHECK(nanoseconds(-1e300) == Nanoseconds::min());
  CHECK(nanoseconds(9.3e9) == Nanoseconds::max());
  CHECK(nanoseconds(std::numeric_limits<double>::quiet_NaN()) == 0ns);
  CHECK(nanoseconds(std::numeric_limits<double>::denorm_min()) == 0ns);
}

TEST_CASE_TEMPLATE("seconds: rounded once, and there and back within half a nanosecond of a day", T, float,
                   double) {
  for (Nanoseconds t : {0ns, 1ns, Nanoseconds(8ms), 999'999'999ns, Nanoseconds(86'400s), Nanoseconds(-3s),
                        Nanoseconds::max(), Nanoseconds::min()}) {
    const double exact = static_cast<double>(t.count()) / 1e9;
    const double unit = static_cast<double>(std::numeric_limits<T>::epsilon());
    CHECK(std::abs(static_cast<double>(seconds<T>(t)) - exact) <= unit * std::abs(exact));
    if (sizeof(T) == 8 && t <= 86'400s && t >= -86'400s)
      CHECK(nanoseconds(static_cast<double>(seconds<T>(t))) == t);
  }
}
