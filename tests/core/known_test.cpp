#include "skinctl/core/known.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "skinctl/core/lane.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;

namespace {
constexpr TypedConstant<0> zero;
constexpr TypedConstant<1> one;
constexpr TypedConstant<-1> minus_one;
constexpr TypedConstant<3> three;

template <class X, class Y>
concept adds = requires(X x, Y y) { x + y; };
}  // namespace

static_assert(std::is_empty_v<TypedConstant<7>>);
static_assert(is_known<TypedConstant<7>> && !is_known<double> && is_zero<TypedConstant<0>> &&
              !is_zero<TypedConstant<1>> && !is_zero<double>);
static_assert(ScalarOrConstant<TypedConstant<2>> && ScalarOrConstant<double> && !ScalarOrConstant<int>);
static_assert(!Scalar<TypedConstant<2>>, "a constant is no storage");
static_assert(std::is_same_v<decltype(three * minus_one), TypedConstant<-3>>);
static_assert(std::is_same_v<decltype(three + minus_one), TypedConstant<2>>);
static_assert(std::is_same_v<decltype(three - minus_one), TypedConstant<4>>);
static_assert(std::is_same_v<decltype(-three), TypedConstant<-3>>);
static_assert(std::is_same_v<decltype(zero * 2.0), TypedConstant<0>> &&
                  std::is_same_v<decltype(2.0 * zero), TypedConstant<0>>,
              "a product with zero is gone, not computed");
static_assert(std::is_same_v<decltype(one * 2.0F), float> && std::is_same_v<decltype(zero + 2.0F), float>);
static_assert(!std::is_convertible_v<TypedConstant<0>, double>,
              "a constant becomes a number only on purpose");
static_assert(double(three) == 3.0);
static_assert(!adds<TypedConstant<1>, const char*>);

TEST_CASE_TEMPLATE("TypedConstant: computes as the number it stands for", T, float, double, Digits50) {
  for (const T& x : {T(0), T(1e-8), T(1), T(-7), T(1e6)}) {
    CHECK(one * x == x);
    CHECK(x * minus_one == -x);
    CHECK(three * x == T(3) * x);
    CHECK(x * three == x * T(3));
    CHECK(zero + x == x);
    CHECK(x + zero == x);
    CHECK(three + x == T(3) + x);
    CHECK(x + three == x + T(3));
    CHECK(x - zero == x);
    CHECK(zero - x == -x);
    CHECK(x - three == x - T(3));
    CHECK(three - x == T(3) - x);
  }
}

TEST_CASE("TypedConstant: zero drops even what is no number") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(double(zero * nan) == 0.0);
  CHECK(std::isnan(one * nan));
}

TEST_CASE_TEMPLATE("TypedConstant: works on every lane at once", T, float, double) {
  const Lane<T> x(T(2));
  static_assert(std::is_same_v<decltype(zero * x), TypedConstant<0>>);
  CHECK((minus_one * x)[0] == T(-2));
  CHECK((three + x)[native_lanes<T> - 1] == T(5));
}
