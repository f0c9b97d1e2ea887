#include "skinctl/clearance/surroundings.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("Surroundings: what is added is kept in order, and what there is no room for is counted") {
  Surroundings<2> near;
  CHECK(near.count == 0);
  for (int i = 0; i < 4; ++i) near.add({{{1.0 * i, 0, 0}, {1.0 * i, 1, 0}, 0.1}, 0.5});
  CHECK(near.count == 4);
  CHECK(near.obstacles[0].shape.from.x == 0);
  CHECK(near.obstacles[1].shape.from.x == 1);
  CHECK(near.obstacles[1].approach == 0.5);
}

TEST_CASE(
    "Surroundings: those of others come into one's own frame, and an unknown one there stays unknown here") {
  // A quarter turn about z, and a metre along x.
  const Transform<Base, World> X_BW({{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}, {1.0, 0.0, 0.0});
  Surroundings<1, World> others;
  others.add({{{0.2, 0, 0}, {0, 0.3, 0.4}, 0.1}, 0.25});
  Surroundings<3, Base> near;
  near.add({{{9, 9, 9}, {9, 9, 9}, 0.2}, 0});
  near.add(X_BW, others);
  REQUIRE(near.count == 2);
  const Capsule<>& c = near.obstacles[1].shape;
  // What X_BW says of the axes of B in W, by hand.
  const Xyz<double> from = X_BW.origin() + X_BW.axes() * Xyz<double>{0.2, 0, 0};
  CHECK(norm(Xyz<double>(c.from - from)) < 1e-15);
  CHECK(norm(Xyz<double>(c.to - c.from)) == doctest::Approx(std::sqrt(0.04 + 0.09 + 0.16)));
  CHECK(std::abs(c.to.z - 0.4) < 1e-15);
  CHECK(std::abs(c.from.x - 1.0) < 1e-15);
  CHECK(std::abs(std::abs(c.from.y) - 0.2) < 1e-15);
  CHECK(c.radius == 0.1);
  CHECK(near.obstacles[1].approach == 0.25);

  others.add({});  // no room for it there
  Surroundings<3, Base> blind;
  blind.add(X_BW, others);
  CHECK(blind.count > 3);
}
