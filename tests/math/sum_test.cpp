#include "skinctl/math/sum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "skinctl/core/lane.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// A running total, as memories keep it.
template <class T>
struct Total {
  T value{0}, rest{0};
  constexpr void operator+=(const T& x) noexcept { math::add_compensated(value, rest, x); }
};
constexpr float small_steps() {
  Total<float> sum{16.0f};
  for (int i = 0; i < 1000; ++i) sum += 1e-7f;
  return sum.value;
}
static_assert(small_steps() > 16.00009f && small_steps() < 16.00011f);

template <class T>
double half_unit() {
  return 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

}  // namespace

TEST_CASE_TEMPLATE("two_sum: value and error are the exact sum, at any sizes", T, float, double) {
  Random random = seeded(1);
  for (int k = 0; k < (skinctl::testing::sanitized ? 2000 : 20000); ++k) {
    const int reach = sizeof(T) == 8 ? 400 : 60;
    const T a = std::ldexp(static_cast<T>(uniform(random, -1.0, 1.0)), k * 7 % reach - reach / 2);
    const T b = std::ldexp(static_cast<T>(uniform(random, -1.0, 1.0)), k * 13 % reach - reach / 2);
    const auto sum = math::two_sum(a, b);
    CHECK(sum.value == a + b);
    CHECK(Digits50(sum.value) + Digits50(sum.error) == Digits50(a) + Digits50(b));
  }
}

TEST_CASE_TEMPLATE(
    "add_compensated: a hundred million steps drift by less than the bound; a plain float stands still", T,
    float) {
  // 2e-9 rad a step from 1 rad on: a joint that creeps for 28 hours at 1 kHz.
  const T step = T(2e-9);
  constexpr int steps = 100'000'000;
  Total<T> sum{T(1)};
  T plain = T(1);
  for (int i = 0; i < steps; ++i) {
    sum += step;
    plain += step;
  }
  const double exact = 1 + static_cast<double>(step) * steps;
  const double u = half_unit<T>();
  CHECK(plain == T(1));
  CHECK(std::abs(static_cast<double>(sum.value) + static_cast<double>(sum.rest) - exact) <=
        u * (exact - 1) + steps * u * u * exact);
  CHECK(std::abs(static_cast<double>(sum.value) - exact) <= 4 * u * exact);
}

TEST_CASE_TEMPLATE("add_compensated: within its bound of 50 digits", T, float, double) {
  Random random = seeded(2);
  const double u = half_unit<T>();
  for (int k = 0; k < (skinctl::testing::sanitized ? 30 : 300); ++k) {
    Digits50 exact = 0;
    double sizes = 0, largest = 0;
    constexpr int terms = 500;
    Total<T> sum;
    for (int i = 0; i < terms; ++i) {
      const int spread = k % 3 == 0 ? 0 : (k % 3 == 1 ? 20 : 60);
      T x = static_cast<T>(uniform(random, -1.0, 1.0) * std::exp2(uniform(random, -1.0, 1.0) * spread));
      if (k % 4 == 0) x = std::abs(x);
      exact += Digits50(x);
      sizes += std::abs(static_cast<double>(x));
      largest = std::max(largest, std::abs(static_cast<double>(exact)));
      sum += x;
    }
    const double error = static_cast<double>(abs(Digits50(sum.value) + Digits50(sum.rest) - exact));
    CHECK(error <= (u * sizes + terms * u * u * largest) * (1 + 1e-6));
    CHECK(std::abs(sum.rest) <= u * 2 * std::abs(sum.value));
  }
}

TEST_CASE_TEMPLATE("add_compensated: what is not finite stays so", T, float, double) {
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                      -std::numeric_limits<T>::infinity()}) {
    Total<T> sum{T(1)};
    sum += bad;
    sum += T(1);
    CHECK_FALSE(sum.value - sum.value == T(0));
  }
}

TEST_CASE_TEMPLATE("add_compensated: lanes add up as their numbers do", T, float, double) {
  using L = Lane<T>;
  Random random = seeded(4);
  Total<L> lanes;
  Total<T> single[L::lanes];
  for (int i = 0; i < 1000; ++i) {
    T x[L::lanes];
    for (std::size_t w = 0; w < L::lanes; ++w) single[w] += x[w] = static_cast<T>(uniform(random, -1.0, 1.0));
    lanes += L::load(x);
  }
  for (std::size_t w = 0; w < L::lanes; ++w) {
    CHECK(lanes.value[w] == single[w].value);
    CHECK(lanes.rest[w] == single[w].rest);
  }
}

TEST_CASE("add_compensated: in 50 digits") {
  Total<Digits50> sum{Digits50(1)};
  for (int i = 0; i < 100; ++i) sum += Digits50(1) / 3;
  CHECK(abs(sum.value + sum.rest - 1 - Digits50(100) / 3) <=
        100 * std::numeric_limits<Digits50>::epsilon() * 34);
}
