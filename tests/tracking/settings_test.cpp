#include "skinctl/tracking/settings.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/control/joint_control.hpp"

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

TEST_CASE(
    "JointControlSettings: gains beyond what the loop's delay allows are refused, with the margin that is "
    "left") {
  // (10 + 27 + 1 + 10 * 0.1) 0.011 = 0.429
  const S by_torque{.dt = 2ms, .loop_delay = 11ms, .lambda = 27, .tb = 0s};
  CHECK_NOTHROW(accept(by_torque));
  S fast = by_torque;
  fast.lambda = (0.5 - 1e-9) / 0.011 - 12;
  CHECK_NOTHROW(accept(fast));
  fast.lambda = 0.51 / 0.011 - 12;
  CHECK_THROWS_WITH_AS(accept(fast),
                       "skinctl: (K_p + lambda + K_i1 + mu K_i2) D = 0.51, allowed: <= 0.5, with D = 11 ms "
                       "and joints up to 1 times "
                       "lighter: stable up to 1.96 times the gain, or joints 1.96 times lighter. Lower the "
                       "gains, lengthen tb (K_p peaks "
                       "at 14.5 / tb) or shorten the delay",
                       ConfigurationError);
  // Times the mass ratio at most 1.
  S light = by_torque;
  light.mass_ratio = 2;
  CHECK_NOTHROW(accept(light));
  light.mass_ratio = 2.5;
  CHECK_THROWS_WITH_AS(accept(light),
                       "skinctl: (K_p + lambda + K_i1 + mu K_i2) D = 0.429, allowed: <= 0.4, with D = 11 ms "
                       "and joints up to 2.5 times "
                       "lighter: stable up to 0.932 times the gain, or joints 2.33 times lighter. Lower the "
                       "gains, lengthen tb (K_p peaks "
                       "at 14.5 / tb) or shorten the delay",
                       ConfigurationError);
  S unknown = by_torque;
  unknown.lambda = 1;
  for (const double bad : {0.99, 4.01, std::numeric_limits<double>::infinity()}) {
    CAPTURE(bad);
    unknown.mass_ratio = bad;
    CHECK_THROWS_AS(accept(unknown), ConfigurationError);
  }
  CHECK_NOTHROW(accept({.dt = 8ms, .loop_delay = 1ms}));  // at least dt
  CHECK_THROWS_WITH_AS(accept({.dt = 8ms, .loop_delay = -1ms}),
                       "skinctl: loop_delay = -1, allowed: 0 to 10 000 ms", ConfigurationError);
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
    CHECK_THROWS_AS(accept({.integral_speed = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.K_c = bad}), ConfigurationError);
    CHECK_THROWS_AS(accept({.settle = bad}), ConfigurationError);
    S s;
    s.max_velocity[4] = bad;
    CHECK_THROWS_AS(accept(s), ConfigurationError);
    S limited;
    limited.integral_limit[5] = bad;
    CHECK_THROWS_AS(accept(limited), ConfigurationError);
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

TEST_CASE(
    "JointControlSettings: gains that do not hold the gravity of another payload are refused by the law") {
  S s{.dt = 2ms, .loop_delay = 11ms, .lambda = 20, .K_i1 = 0, .K_i2 = 0, .tb = 0s, .K_c = 5};
  const auto law = [](const S& settings) { static_cast<void>(JointControl<6>(settings)); };
  s.gravity_rate = 99.9;  // lambda K_c = 100 1/s^2
  CHECK_NOTHROW(law(s));
  s.gravity_rate = 100.1;
  CHECK_THROWS_WITH_AS(
      law(s),
      "skinctl: lambda (K_c + K_i1) + K_c K_i1 - lambda K_c K_i1 / (lambda + K_c + K_i1) = 100 "
      "1/s^2, allowed: >= 100, or a lost payload's gravity carries a joint away: declare the "
      "rotors' inertia, shorten the delay or tell the payload",
      ConfigurationError);
  s.K_i1 = 5;  // 20 (5 + 5) + 25 - 500 / 30 = 208.3
  s.gravity_rate = 208;
  CHECK_NOTHROW(law(s));
  s.gravity_rate = 209;
  CHECK_THROWS_AS(law(s), ConfigurationError);
}
