#include "skinctl/tracking/settings.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace skinctl;

namespace {
using S = JointControlSettings<6>;
void accept(const S& s) {
  check(s, s.lambda);
}
}  // namespace

TEST_CASE("JointControlSettings: the defaults work at every usual rate") {
  for (const double rate : {100.0, 125.0, 250.0, 500.0, 1000.0, 4000.0}) {
    CAPTURE(rate);
    CHECK_NOTHROW(accept({.dt = nanoseconds(1 / rate)}));
    CHECK(S{.dt = nanoseconds(1 / rate)}.lambda == doctest::Approx(0.25 * rate));
  }
  CHECK_NOTHROW(check(JointControlSettings<3, float>{.dt = 8ms}, 31.25f));
}

TEST_CASE("JointControlSettings: gains beyond the bound of sampled time are refused, with number and range") {
  // (14.465 + 31.25 + 1 + 10 * 0.1) * 0.008 = 0.3817
  CHECK_NOTHROW(accept({.dt = 8ms}));
  CHECK_THROWS_WITH_AS(
      accept({.dt = 8ms, .lambda = 50}),
      "skinctl: (K_p + lambda + K_i1 + mu K_i2) dt = 0.531717162, allowed: <= 0.5: lower the gains, "
      "lengthen tb (K_p peaks at 14.5 / tb) or shorten dt",
      ConfigurationError);
  CHECK_THROWS_AS(accept({.dt = 8ms, .tb = 300ms}), ConfigurationError);  // K_p peaks at 48
  CHECK_THROWS_AS(accept({.dt = 8ms, .tb = 0s, .K_c = 40}), ConfigurationError);
  CHECK_THROWS_AS(accept({.dt = 8ms, .K_i1 = 20}), ConfigurationError);
  CHECK_THROWS_AS(accept({.dt = 8ms, .K_i2 = 2}), ConfigurationError);
  CHECK_THROWS_AS(accept({.dt = 8ms, .mu = 200}), ConfigurationError);
  CHECK_THROWS_AS(accept({.dt = 8ms, .kappa = 38}), ConfigurationError);  // kappa dt > 0.3
}

TEST_CASE("JointControlSettings: numbers that mean nothing are refused, NaN as well") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(accept({.lambda = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.kappa = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.K_i1 = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.K_i2 = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.mu = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.integral_limit = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.K_c = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.settle = bad}), ConfigurationError);
    S s;
    s.max_velocity[4] = bad;
    CHECK_THROWS_AS(accept(s), ConfigurationError);
  }
  for (const Nanoseconds bad : {nanoseconds(-1), Nanoseconds::min(), Nanoseconds::max(),
                                nanoseconds(std::numeric_limits<double>::infinity())}) {
    CAPTURE(bad.count());
    CHECK_THROWS_AS(accept({.dt = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.tb = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.bumpless_transfer = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.target_age = bad}), ConfigurationError);
  }
  // Seconds that are no number are no duration.
  CHECK_THROWS_AS(accept({.dt = nanoseconds(nan)}), ConfigurationError);
  CHECK_THROWS_AS(accept({.bumpless_transfer = nanoseconds(nan)}), ConfigurationError);
  CHECK_THROWS_AS(accept({.target_age = nanoseconds(nan)}), ConfigurationError);
  CHECK_THROWS_WITH_AS(accept({.dt = 0s}), "skinctl: dt = 0, allowed: > 0 and <= 1000 ms",
                       ConfigurationError);
}
