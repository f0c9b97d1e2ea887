#include "skinctl/frames/point.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "tests/support/digits50.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
template <class X, class Y>
concept has_sum = requires(X x, Y y) { x + y; };
template <class X, class Y>
concept has_difference = requires(X x, Y y) { x - y; };
template <class X, class Y>
concept has_dot = requires(X x, Y y) { dot(x, y); };
template <class X, class Y>
concept has_cross = requires(X x, Y y) { cross(x, y); };
}  // namespace

static_assert(has_difference<Point<World>, Point<World>> && !has_sum<Point<World>, Point<World>>);
static_assert(!has_difference<Point<World>, Point<Base>>);
static_assert(has_sum<Point<World>, FreeVector<World>> && !has_sum<Point<World>, FreeVector<Base>>);
static_assert(has_sum<FreeVector<World>, FreeVector<World>> && !has_sum<FreeVector<World>, FreeVector<Base>>);
static_assert(has_difference<FreeVector<World>, FreeVector<World>> &&
              !has_difference<FreeVector<World>, FreeVector<Base>>);
static_assert(!has_sum<FreeVector<World, float>, FreeVector<World, double>>);
static_assert(has_dot<FreeVector<World>, FreeVector<World>> && !has_dot<FreeVector<World>, FreeVector<Base>>);
static_assert(has_cross<FreeVector<World>, FreeVector<World>> &&
              !has_cross<FreeVector<World>, FreeVector<Base>>);
static_assert(has_sum<Offset<World, Base, Cell>, Offset<Base, Tool, Cell>>);
static_assert(!has_sum<Offset<World, Base, Cell>, Offset<World, Base, Cell>>, "p_AB + p_AB goes nowhere");
static_assert(!has_sum<Offset<World, Base, Cell>, Offset<Base, Tool, World>>, "other axes");
static_assert(std::is_same_v<decltype(Offset<World, Base, Cell>{} + Offset<Base, Tool, Cell>{}),
                             Offset<World, Tool, Cell>>);
static_assert(std::is_same_v<decltype(-Offset<World, Base, Cell>{}), Offset<Base, World, Cell>>);
static_assert(std::is_trivially_copyable_v<Point<World>> && sizeof(Point<World, float>) == 3 * sizeof(float));
static_assert(sizeof(Offset<World, Base, Cell>) == 3 * sizeof(double));

TEST_CASE_TEMPLATE("Point: goes to another point by their difference", T, float, double, Digits50) {
  auto rng = seeded(1);
  for (const T& reach : {T(0), T(1e-8), T(1), T(1e6)}) {
    const Point<World, T> a{random_xyz(rng, reach)}, b{random_xyz(rng, reach)};
    CHECK(largest((b + (a - b)).xyz - a.xyz) <= T(4) * epsilon<T>() * reach);
    CHECK(largest(((a - b) + (b - a)).xyz) == T(0));
  }
}

TEST_CASE_TEMPLATE("Offset: chains, and comes back by its negative", T, float, double, Digits50) {
  auto rng = seeded(2);
  const Offset<World, Base, Cell, T> p_WB_C{random_xyz(rng, T(1))};
  const Offset<Base, World, Cell, T> back = -p_WB_C;
  CHECK(largest((p_WB_C + back).xyz) == T(0));
}

TEST_CASE_TEMPLATE("FreeVector: has the products of a vector", T, float, double, Digits50) {
  auto rng = seeded(3);
  const FreeVector<World, T> u{random_xyz(rng, T(1))}, v{random_xyz(rng, T(1))};
  using std::abs;
  CHECK(abs(dot(cross(u, v), u)) <= T(4) * epsilon<T>());
  CHECK(largest((cross(u, v) + cross(v, u)).xyz) <= T(2) * epsilon<T>());
  CHECK(largest(((T(2) * u - u) + -u).xyz) == T(0));
}

TEST_CASE("Point: Eigen sees the three coordinates") {
  const Vec3<double> v(1, 2, 3);
  CHECK(as_eigen(Point<World>::from_eigen(v)) == v);
  CHECK(as_eigen(FreeVector<World>::from_eigen(v)) == v);
  CHECK(as_eigen(Offset<World, Base, Cell>::from_eigen(v)) == v);
}

TEST_CASE_TEMPLATE("FreeVector: norm and dot", T, float, double) {
  const FreeVector<World, T> v{{T(2), T(3), T(6)}};
  CHECK(norm(v) == T(7));
  CHECK(dot(v, v) == T(49));
}
