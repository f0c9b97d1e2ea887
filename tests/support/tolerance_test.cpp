#include "tests/support/tolerance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <array>

#include "skinctl/core/joint.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("allowed: scales with the type and the magnitude, never to nothing", T, float, double,
                   Digits50) {
  const T epsilon = std::numeric_limits<T>::epsilon();
  CHECK(allowed(T(1)) == T(64) * epsilon);
  CHECK(allowed(T(-8)) == T(512) * epsilon);
  CHECK(allowed(T(1024), 2) == T(2048) * epsilon);
  CHECK(allowed(T(0)) == std::numeric_limits<T>::min());
}

TEST_CASE_TEMPLATE("difference: a rounding error passes, a wrong digit does not", T, float, double,
                   Digits50) {
  const T third = T(1) / T(3);
  CHECK(difference(T(third + third + third), T(1)) <= allowed(T(1)));
  CHECK_FALSE(difference(T(1), T(T(1) + T(1000) * std::numeric_limits<T>::epsilon())) <= allowed(T(1)));
}

TEST_CASE_TEMPLATE("difference: what is not a number never passes", T, float, double) {
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const T infinity = std::numeric_limits<T>::infinity();
  CHECK_FALSE(difference(nan, T(1)) <= allowed(T(1e6)));
  CHECK_FALSE(difference(nan, nan) <= allowed(T(1e6)));
  CHECK_FALSE(difference(infinity, -infinity) <= allowed(T(1e6)));
  CHECK(difference(infinity, infinity) == 0);
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<T, 3> a{1, 2, 3};
    const auto b = a;
    a[i] = nan;
    CHECK_FALSE(difference(a, b) <= allowed(T(1e6)));
    CHECK_FALSE(difference(b, a) <= allowed(T(1e6)));
  }
}

TEST_CASE("difference: the largest of any component") {
  CHECK(difference(std::array<double, 3>{1, 2, 3}, std::array<double, 3>{1, 2.5, 2.75}) == 0.5);
  CHECK(difference(JointTorque<2>{1.0, 2.0}, JointTorque<2>{4.0, 2.0}) == 3);
  const Eigen::Matrix2d a{{1, 2}, {3, 4}};
  const Eigen::Matrix2d b{{1, 2}, {-3, 4}};
  CHECK(difference(a, b) == 6);
  CHECK(difference(a, a.transpose()) == 1);
  struct Triple {
    double x, y, z;
  };
  CHECK(difference(Triple{1, 2, 3}, Triple{1, 2, 7}) == 4);
}
