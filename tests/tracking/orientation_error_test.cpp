#include "skinctl/tracking/orientation_error.hpp"

#include <doctest/doctest.h>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
Xyz<double> random_vector(Seeded& rng, double size) {
  return {size * rng(), size * rng(), size * rng()};
}
double distance(const Xyz<double>& a, const Xyz<double>& b) {
  return std::sqrt(dot(a - b, a - b));
}
}  // namespace

TEST_CASE_TEMPLATE("OrientationErrors: slope is the derivative of e, and the map gives omega back", E,
                   RotationVectorError, ZyzError) {
  Seeded rng(3);
  for (int k = 0; k < 200; ++k) {
    const auto R0 = exp_so3(random_vector(rng, 1)) * rotation_zyz(Zyz<double>{rng(), 1.2, rng()});
    const auto R_d0 = exp_so3(random_vector(rng, 0.4)) * R0;
    const auto w = random_vector(rng, 1), w_d = random_vector(rng, 0.5), a_d = random_vector(rng, 0.5);
    const Xyz<double> near{0, 0, 0};
    const auto target = [&](double t) {
      return RotationReference<double>{exp_so3(Xyz<double>(t * w_d + 0.5 * t * t * a_d)) * R_d0,
                                       w_d + t * a_d, a_d};
    };
    const auto at = [&](double t) { return E::errors(exp_so3(Xyz<double>(t * w)) * R0, w, target(t), near); };
    const double h = 1e-6;
    const auto now = at(0), ahead = at(h), behind = at(-h);
    CHECK(distance((1 / (2 * h)) * (ahead.e - behind.e), now.slope) < 2e-7);
    CHECK(distance((1 / (2 * h)) * (ahead.v_d - behind.v_d), now.a_d) < 2e-7);

    // de = x - v_d, where x is what the map turns into omega.
    const auto map = E::map(R0, w, now.branch);
    const auto x = now.de + now.v_d;
    CHECK(distance(map.omega(x), w) < 1e-12);
    const auto x_at = [&](double t) {
      const auto e = at(t);
      return Xyz<double>(e.de + e.v_d);
    };
    CHECK(distance(map.domega(x, (1 / (2 * h)) * (x_at(h) - x_at(-h))), {0, 0, 0}) <
          1e-6);  // omega is constant
    // At the target there is no error.
    CHECK(distance(E::errors(R0, w, {R0, w, a_d}, near).e, {0, 0, 0}) < 1e-12);
  }
}
