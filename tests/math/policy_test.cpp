#include "skinctl/math/policy.hpp"

#include <doctest/doctest.h>

#include "skinctl/math/sincos.hpp"

using namespace skinctl;

TEST_CASE("policy: both choices agree to rounding, and the default is the fast one") {
  for (double x = -3; x < 3; x += 0.01) {
    CHECK(math::sincos(x).sin == math::sincos<math::Fast>(x).sin);
    CHECK(std::abs(math::sincos<math::Fast>(x).sin - math::sincos<math::Libm>(x).sin) <= 3e-16);
  }
}
