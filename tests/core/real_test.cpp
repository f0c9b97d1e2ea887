#include "skinctl/core/real.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <type_traits>

#include "skinctl/core/lane.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;

namespace {}

static_assert(Real<float> && Real<double> && Real<long double> && Real<Digits50>);
static_assert(!Real<int> && !Real<bool> && !Real<std::string> && !Real<Lane<double>>);
static_assert(Scalar<float> && Scalar<Digits50> && Scalar<Lane<double>> && Scalar<Lane<float>>);
static_assert(!Scalar<int> && !Scalar<double*>);
static_assert(std::is_same_v<RealOf<double>, double> && std::is_same_v<RealOf<Digits50>, Digits50>);
static_assert(std::is_same_v<RealOf<Lane<float>>, float>);

TEST_CASE_TEMPLATE("Real: the tolerance follows the type and holds for a chain of operations", T, float,
                   double, Digits50) {
  using std::abs;
  CHECK(tolerance<T> == T(64) * std::numeric_limits<T>::epsilon());
  T x(1);
  for (int i = 0; i < 20; ++i) x = x / T(3);
  for (int i = 0; i < 20; ++i) x = x * T(3);
  CHECK(abs(T(x - T(1))) > T(0));
  CHECK(abs(T(x - T(1))) <= tolerance<T>);
}
