#include "skinctl/sensing/hampel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<Hampel<>::Memory>);

TEST_CASE_TEMPLATE("Hampel: the rule by definition, at random samples and times", T, float, double) {
  auto random = seeded(5);
  const Hampel<T> filter(T(0.01));
  typename Hampel<T>::Memory m;
  T x[3] = {};
  Nanoseconds t[3] = {};
  int replaced = 0;
  for (int k = 0; k < 20000; ++k) {
    x[0] = x[1], x[1] = x[2], t[0] = t[1], t[1] = t[2];
    x[2] =
        static_cast<T>(uniform(random, 0.0, 0.02) + (random() % 20 == 0 ? uniform(random, -1.0, 1.0) : 0.0));
    t[2] += nanoseconds(uniform(random, 1e-4, 1e-1));
    const auto out = filter.take(m, t[2], x[2]);
    CHECK(out.valid == (k > 0));
    if (k < 2) continue;
    CHECK(out.time == t[1]);
    T sorted[3] = {x[0], x[1], x[2]};
    std::sort(sorted, sorted + 3);
    T off[3];
    for (int i = 0; i < 3; ++i) off[i] = std::abs(x[i] - sorted[1]);
    std::sort(off, off + 3);
    const bool peak = std::abs(x[1] - sorted[1]) > std::max(T(3) * T(1.4826) * off[1], T(3) * T(0.01));
    CHECK(out.replaced == peak);
    if (!peak) {
      CHECK(out.value == x[1]);
      continue;
    }
    ++replaced;
    const double share = seconds<double>(t[1] - t[0]) / seconds<double>(t[2] - t[0]);
    CHECK(double(out.value) == doctest::Approx(double(x[0]) + share * double(x[2] - x[0])).epsilon(1e-5));
  }
  CHECK(replaced > 500);
}

TEST_CASE("Hampel: a peak goes, edges and ramps stay to the bit") {
  const Hampel<> filter(0.001);
  Hampel<>::Memory m;
  int peaks = 0;
  for (int k = 0; k < 100; ++k) {
    const double x = k < 50 ? 0.01 * k : 2.0;  // a ramp, then an edge
    const auto out = filter.take(m, k * 4ms + (k % 3) * 1ms, k == 20 ? 5.0 : x);
    if (!out.valid) continue;
    peaks += out.replaced;
    const double was = k <= 50 ? 0.01 * (k - 1) : 2.0;
    if (k == 21) {
      CHECK(out.replaced);
      CHECK(out.value == doctest::Approx(0.01 * (19 + 2 * 6.0 / 7)).epsilon(0.2));
    } else if (k != 20 && k != 22) {
      CHECK(out.value == was);
    }
  }
  CHECK(peaks == 1);
}

TEST_CASE("Hampel: extremes, and what it refuses") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::max();
  const Hampel<> filter(1e-300);
  Hampel<>::Memory m;
  CHECK(filter.take(m, 0ns, nan).status == Status(Reason::sample_not_finite));
  CHECK_FALSE(filter.take(m, Nanoseconds::min(), 0.0).valid);
  CHECK(filter.take(m, 0ns, huge).value == 0);
  const auto out = filter.take(m, Nanoseconds::max(), -huge);
  CHECK(out.value - out.value == 0);
  CHECK(filter.take(m, 0ns, 1.0).status == Status(Reason::time_backwards));
  CHECK_THROWS_AS(Hampel<>(0.0), ConfigurationError);
  CHECK_THROWS_AS(Hampel<>(nan + 0), ConfigurationError);
  CHECK_THROWS_AS(Hampel<>(1.0, 0.5), ConfigurationError);
}
