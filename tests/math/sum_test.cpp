#include "skinctl/math/sum.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/core/lane.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/math/exact_error.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using math::Compensated;
using math::DoubleWord;
using math::Sum;

namespace {

constexpr float small_steps() {
  Sum<float> sum(16.0f);
  for (int i = 0; i < 1000; ++i) sum += 1e-7f;
  return sum.value();
}
static_assert(small_steps() > 16.00009f && small_steps() < 16.00011f);
static_assert(std::is_trivially_copyable_v<Sum<float>>);
static_assert(sizeof(Sum<double>) == 2 * sizeof(double));
static_assert(Sum<double>().value() == 0.0);

template <class T>
double half_unit() {
  return 0.5 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// What the bounds in the header are made of.
template <class T>
struct Track {
  Digits50 total = 0;
  double sizes = 0, largest = 0;
  double terms = 0;
  void add(T x) {
    total += Digits50(x);
    sizes += std::abs(static_cast<double>(x));
    largest = std::max(largest, std::abs(static_cast<double>(total)));
    ++terms;
  }
};

template <class T, class Policy>
double excess(const Track<T>& exact, const Sum<T, Policy>& sum) {
  const double u = half_unit<T>();
  const double bound = std::is_same_v<Policy, Compensated>
                           ? u * exact.sizes + exact.terms * u * u * exact.largest
                           : 2 * exact.terms * u * u * exact.largest;
  const double error =
      static_cast<double>(abs(Digits50(Digits50(sum.value()) + Digits50(sum.rest()) - exact.total)));
  return error - bound * (1 + 1e-6);
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
    const auto ordered = std::abs(a) >= std::abs(b) ? math::fast_two_sum(a, b) : math::fast_two_sum(b, a);
    CHECK(ordered.value == sum.value);
    CHECK(ordered.error == sum.error);
  }
}

TEST_CASE_TEMPLATE("Sum: a hundred million steps drift by less than the bound; a plain float stands still", T,
                   float) {
  // 2e-9 rad a step from 1 rad on: a joint that creeps for 28 hours at 1 kHz.
  const T step = T(2e-9);
  constexpr int steps = 100'000'000;
  Sum<T> sum(T(1));
  T plain = T(1);
  for (int i = 0; i < steps; ++i) {
    sum += step;
    plain += step;
  }
  const double exact = 1 + static_cast<double>(step) * steps;
  const double u = half_unit<T>();
  CHECK(plain == T(1));
  CHECK(std::abs(static_cast<double>(sum.value()) + static_cast<double>(sum.rest()) - exact) <=
        u * (exact - 1) + steps * u * u * exact);
  CHECK(std::abs(static_cast<double>(sum.value()) - exact) <= 4 * u * exact);
}

TEST_CASE_TEMPLATE("Sum: within its bound of 50 digits", T, float, double) {
  Random random = seeded(2);
  for (int k = 0; k < (skinctl::testing::sanitized ? 30 : 300); ++k) {
    Track<T> exact;
    Sum<T> compensated;
    Sum<T, DoubleWord> twice;
    for (int i = 0; i < 500; ++i) {
      const int spread = k % 3 == 0 ? 0 : (k % 3 == 1 ? 20 : 60);
      T x = static_cast<T>(uniform(random, -1.0, 1.0) * std::exp2(uniform(random, -1.0, 1.0) * spread));
      if (k % 4 == 0) x = std::abs(x);
      exact.add(x);
      compensated += x;
      twice += x;
    }
    CHECK(excess(exact, compensated) <= 0);
    CHECK(excess(exact, twice) <= 0);
    CHECK(std::abs(compensated.rest()) <= half_unit<T>() * 2 * std::abs(compensated.value()));
    CHECK(std::abs(twice.rest()) <= half_unit<T>() * 2 * std::abs(twice.value()));
  }
}

TEST_CASE_TEMPLATE("Sum: a state that swings keeps its place where DoubleWord is asked for", T, float,
                   double) {
  // There and back a million times, under the sanitizers a hundred thousand: the compensated sum rounds each
  // step, the double word does not.
  Random random = seeded(3);
  Sum<T> compensated(T(0.7));
  Sum<T, DoubleWord> twice(T(0.7));
  Digits50 exact(T(0.7));
  std::vector<T> steps(1000);
  for (T& x : steps) {
    x = static_cast<T>(uniform(random, -0.01, 0.01));
    exact += Digits50(x);
  }
  for (int k = 0; k < (skinctl::testing::sanitized ? 100 : 1000); ++k) {
    for (const T x : steps) compensated += x, twice += x;
    if (k % 2 == 0)
      for (const T x : steps) compensated -= x, twice -= x;
    else
      for (std::size_t i = steps.size(); i-- > 0;) compensated -= steps[i], twice -= steps[i];
  }
  for (const T x : steps) twice += x;
  CHECK(error_in_ulp(twice.value(), exact) <= 0.6);
  const double u = half_unit<T>();
  CHECK(std::abs(double(compensated.value()) - double(T(0.7))) <= u * 2e6 * 0.005 * 2);
}

TEST_CASE_TEMPLATE("Sum: what is not finite stays so", T, float, double) {
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                      -std::numeric_limits<T>::infinity()}) {
    Sum<T> compensated(T(1));
    Sum<T, DoubleWord> twice(T(1));
    compensated += bad, twice += bad;
    compensated += T(1), twice += T(1);
    CHECK_FALSE(compensated.value() - compensated.value() == T(0));
    CHECK_FALSE(twice.value() - twice.value() == T(0));
  }
}

TEST_CASE_TEMPLATE("Sum: lanes add up as their numbers do", T, float, double) {
  using L = Lane<T>;
  Random random = seeded(4);
  Sum<L> lanes;
  Sum<L, DoubleWord> lanes_twice;
  Sum<T> single[L::lanes];
  Sum<T, DoubleWord> single_twice[L::lanes];
  for (int i = 0; i < 1000; ++i) {
    T x[L::lanes];
    for (std::size_t w = 0; w < L::lanes; ++w) {
      x[w] = static_cast<T>(uniform(random, -1.0, 1.0));
      single[w] += x[w], single_twice[w] += x[w];
    }
    lanes += L::load(x), lanes_twice += L::load(x);
  }
  for (std::size_t w = 0; w < L::lanes; ++w) {
    CHECK(lanes.value()[w] == single[w].value());
    CHECK(lanes.rest()[w] == single[w].rest());
    CHECK(lanes_twice.value()[w] == single_twice[w].value());
  }
}

TEST_CASE("Sum: in 50 digits") {
  Sum<Digits50> sum(Digits50(1));
  for (int i = 0; i < 100; ++i) sum += Digits50(1) / 3;
  CHECK(abs(sum.value() + sum.rest() - 1 - Digits50(100) / 3) <=
        100 * std::numeric_limits<Digits50>::epsilon() * 34);
}
