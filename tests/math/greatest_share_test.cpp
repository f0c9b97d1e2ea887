#include "skinctl/math/greatest_share.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE(
    "greatest_share: within a step below the border, never above, in a bounded number of questions", T, float,
    double) {
  Random random = seeded(3);
  for (int i = 0; i < 2000; ++i) {
    const T border = uniform<T>(random, T(-0.2), T(1.2));
    int asked = 0;
    const T share = math::greatest_share<12, T>([&](const T& s) {
      ++asked;
      CHECK(s > T(0));
      CHECK(s < T(1));
      return s <= border;
    });
    CHECK(asked == 12);
    CHECK(share * T(4096) == std::floor(share * T(4096)));
    CHECK((share <= border || share == T(0)));
    CHECK(share >= std::fmin(border, T(1)) - T(1) / T(4096));
  }
}

TEST_CASE("greatest_share: nothing holds, all holds, and what cannot be compared") {
  CHECK(math::greatest_share<10, double>([](double) { return false; }) == 0);
  CHECK(math::greatest_share<10, double>([](double) { return true; }) == 1 - 1.0 / 1024);
  CHECK(math::greatest_share<10, double>([](double s) { return s < std::nan(""); }) == 0);
}
