#include "skinctl/testing/random.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>

#include "skinctl/core/joint.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("Random: the same seed gives the same numbers, in range and spread over it", T, float,
                   double, Digits50) {
  auto one = seeded(42);
  auto two = seeded(42);
  auto three = seeded(43);
  T sum(0);
  T least(10);
  T most(-10);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const T value = uniform(one, T(-2), T(3));
    REQUIRE(value == uniform(two, T(-2), T(3)));
    if (value == uniform(three, T(-2), T(3))) ++equal;
    sum += value;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  CHECK(equal < 3);
  CHECK(least >= T(-2));
  CHECK(least < T(-1.9));
  CHECK(most <= T(3));
  CHECK(most > T(2.9));
  CHECK(std::abs(static_cast<double>(sum) / 1000 - 0.5) < 0.15);
}

TEST_CASE("Random: the last digits of a wide number are random as well") {
  auto random = seeded(1);
  const Digits50 value = uniform(random, Digits50(0), Digits50(1));
  CHECK(value != Digits50(static_cast<double>(value)));
  CHECK(abs(Digits50(sin(pi<Digits50>()))) < Digits50("1e-49"));
}

TEST_CASE_TEMPLATE("Random: every extreme of either sign is drawn", T, float, double) {
  auto random = seeded(7);
  std::array<int, 5> positive{};
  std::array<int, 5> negative{};
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const T value = random_or_extreme(random, T(0.5));
    if (std::abs(value) <= T(0.5)) ++inside;
    const auto list = extremes<T>();
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (value == list[k]) ++positive[k];
      if (value == -list[k]) ++negative[k];
    }
  }
  for (std::size_t k = 0; k < positive.size(); ++k) {
    CAPTURE(k);
    CHECK(positive[k] > 50);
    CHECK(negative[k] > 50);
  }
  CHECK(inside > 3000);
}

TEST_CASE("as_code: what it prints reads back as the same number") {
  auto random = seeded(3);
  for (int i = 0; i < 1000; ++i) {
    const double value = random_or_extreme(random, 1e3);
    CHECK(std::strtod(as_code(value).c_str(), nullptr) == value);
    const float single = random_or_extreme(random, 1e3f);
    CHECK(std::strtof(as_code(single).c_str(), nullptr) == single);
    const Digits50 wide = random_or_extreme(random, Digits50(1000));
    const std::string text = as_code(wide);
    REQUIRE(text.size() > 9);
    CHECK(Digits50(text.substr(10, text.size() - 12)) == wide);
  }
}

TEST_CASE("as_code: numbers, arrays, joint vectors, triples and matrices as they stand in a program") {
  CHECK(as_code(1.0) == "1.0");
  CHECK(as_code(-0.5f) == "-0.5f");
  CHECK(as_code(1e300) == "1.0000000000000001e+300");
  CHECK(as_code(Digits50(2)) == "Digits50(\"2\")");
  CHECK(as_code(std::numeric_limits<double>::infinity()) == "std::numeric_limits<double>::infinity()");
  CHECK(as_code(-std::numeric_limits<float>::infinity()) == "-std::numeric_limits<float>::infinity()");
  CHECK(as_code(std::numeric_limits<double>::quiet_NaN()) == "std::numeric_limits<double>::quiet_NaN()");
  CHECK(as_code(std::array<double, 2>{1, 2.5}) == "{1.0, 2.5}");
  CHECK(as_code(JointPosition<2>{1.0, 2.5}) == "{1.0, 2.5}");
  CHECK(as_code(Eigen::Matrix<double, 2, 2>{{1, 2}, {3, 4}}) == "{{1.0, 2.0}, {3.0, 4.0}}");
  CHECK(as_code(Xyz<float>{1, 2, 3}) == "{1.0f, 2.0f, 3.0f}");
}
