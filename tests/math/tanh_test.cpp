#include "skinctl/math/tanh.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/support/digits50.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
TEST_CASE_TEMPLATE("tanh: within 3 units in the last place of 50 digits, odd, and never beyond 1", T, float,
                   double) {
  oracle::Random random(1);
  double worst = 0;
  for (int k = 0; k < 4000; ++k) {
    const double reach = k % 4 == 0 ? 1e-8 : k % 4 == 1 ? 0.5 : k % 4 == 2 ? 3 : 30;
    const T x = static_cast<T>(random.uniform(-reach, reach));
    const T y = math::tanh(x);
    CHECK(math::tanh(T(-x)) == -y);
    CHECK(std::abs(y) <= T(1));
    const Digits50 exact = tanh(Digits50(x));
    if (exact == 0) continue;
    const T size = std::abs(static_cast<T>(exact));
    const T unit = std::nextafter(size, std::numeric_limits<T>::infinity()) - size;
    worst = std::max(worst, static_cast<double>(abs(Digits50(y) - exact) / Digits50(unit)));
  }
  CHECK(worst <= 3);
}

TEST_CASE_TEMPLATE("tanh: the ends", T, float, double) {
  CHECK(math::tanh(T(25)) == T(1));
  CHECK(math::tanh(std::numeric_limits<T>::infinity()) == T(1));
  CHECK(math::tanh(-std::numeric_limits<T>::infinity()) == T(-1));
  CHECK(std::isnan(math::tanh(std::numeric_limits<T>::quiet_NaN())));
  CHECK(std::signbit(math::tanh(T(-0.0))));
}
