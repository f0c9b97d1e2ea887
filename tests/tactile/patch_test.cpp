#include "skinctl/tactile/patch.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("unit_wrench: one newton inwards, no moment about the cell, some about the link") {
  Random rng = seeded(1);
  for (int k = 0; k < 1000; ++k) {
    const Transform<Link<2>, Cell> X_LC(random_rotation<double>(rng), random_xyz(rng, 0.5));
    const auto u = unit_wrench(X_LC);
    // Seen from the cell it is a pure force along -z.
    const auto u_C = X_LC.inverse() * u;
    CHECK(norm(u_C.force - Xyz<double>{0, 0, -1}) <= 1e-14);
    CHECK(norm(u_C.moment) <= 1e-14);
    // Along the force's own line there is no moment, elsewhere there is.
    CHECK(std::abs(dot(u.force, u.moment)) <= 1e-15);
    // Work on a link that moves: the inward speed of the cell's origin.
    const Twist<Link<2>, Base, Link<2>, Link<2>> V{random_xyz(rng, 1.0), random_xyz(rng, 1.0)};
    const Xyz<double> v_C = V.linear + cross(V.angular, X_LC.origin());
    CHECK(std::abs(power(u, V) + dot(v_C, X_LC.axis_z())) <= 1e-14);
  }
}

TEST_CASE("Patch: what cannot be is refused with its number") {
  using Cells = std::vector<PlacedCell<1>>;
  const Transform<Link<1>, Cell> at = Transform<Link<1>, Cell>::translation_xyz(0.1, 0, 0);
  using Two = Patch<1, 2>;
  CHECK_THROWS_WITH_AS(Two(Cells{{1, at}}), "skinctl: Patch: number of cells = 1, allowed: 2",
                       ConfigurationError);
  CHECK_NOTHROW(Two(Cells{{1, at}, {2, at}}));
  CHECK_NOTHROW(Two(Cells{{1, at}, {2, at}}, CellGains{0, 0}));
  CHECK_THROWS_WITH_AS(Two(Cells{{1, at}, {2, at}}, CellGains{-1, 0}),
                       "skinctl: Patch: gain of force = -1, allowed: 0 to 1e4 N", ConfigurationError);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, at}}, CellGains{nan, 0}), ConfigurationError);
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, at}}, CellGains{1, inf}), ConfigurationError);
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, at}}, CellGains{1, -1}), ConfigurationError);
  using X = Transform<Link<1>, Cell>;
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, X::translation_xyz(nan, 0, 0)}}), ConfigurationError);
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, X::translation_xyz(0, inf, 0)}}), ConfigurationError);
  const Rotation<double> skew{{1.0, 0.0, 0.0}, {0.1, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, X::trusted(skew, {})}}), ConfigurationError);
  const Rotation<double> left{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}};
  CHECK_THROWS_AS(Two(Cells{{1, at}, {2, X::trusted(left, {})}}), ConfigurationError);
}
