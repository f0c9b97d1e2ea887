// Promise: the distance of two capsules is exact to 8 units in the last place of 1 m
// Tried: 4000 pairs, nearly parallel ones and points among them, against 50 digits, float and double
// (differences of squares: 0.8 mm in float)

#include "skinctl/clearance/capsule.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/testing/random.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// The distance of two segments by descent on both parameters, from a coarse grid: no formula shared.
double searched(const Capsule<>& a, const Capsule<>& b) {
  const auto far = [&](double s, double t) {
    const auto way = a.from + s * (a.to - a.from) - (b.from + t * (b.to - b.from));
    return std::sqrt(dot(way, way));
  };
  double best = 1e9, s = 0, t = 0;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 20; ++j)
      if (far(i / 20.0, j / 20.0) < best) best = far(i / 20.0, j / 20.0), s = i / 20.0, t = j / 20.0;
  for (double step = 0.05; step > 1e-9; step *= 0.7)
    for (int k = 0; k < 8; ++k)
      for (const auto& [ds, dt] :
           {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
        const double x = std::clamp(s + step * ds, 0.0, 1.0), y = std::clamp(t + step * dt, 0.0, 1.0);
        if (far(x, y) < best) best = far(x, y), s = x, t = y;
      }
  return best - a.radius - b.radius;
}
}  // namespace

TEST_CASE("capsules: the distance is that of a search over both segments") {
  auto rng = seeded(9);
  const auto point = [&] {
    return Xyz<double>{uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0)};
  };
  double worst = 0;
  for (int k = 0; k < 400; ++k) {
    Capsule<> a{point(), point(), 0.1}, b{point(), point(), 0.05};
    if (k % 5 == 1) b.to = b.from;
    if (k % 5 == 2) a.to = a.from;
    if (k % 5 == 3) b.to = b.from + 0.7 * (a.to - a.from);
    if (k % 10 == 2) b.to = b.from;
    const auto d = distance(a, b);
    worst = std::max(worst, std::abs(d.distance - searched(a, b)));
    const auto way = d.a - d.b;
    CHECK(std::abs(std::sqrt(dot(way, way)) - 0.15 - d.distance) < 1e-12);
    CHECK(std::abs(distance(b, a).distance - d.distance) < 1e-9);
    if (k % 5 == 2) CHECK(std::abs(distance(a.from, b) - 0.1 - d.distance) < 1e-9);
  }
  CHECK(worst < 1e-6);
}

TEST_CASE_TEMPLATE(
    "capsules: the distance is exact to a few units in the last place, nearly parallel ones included", T,
    float, double) {
  Seeded rng(23);
  const T eps = std::numeric_limits<T>::epsilon();
  T worst = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto point = [&] { return Xyz<T>{T(rng()), T(rng()), T(rng())}; };
    Capsule<T> a{point(), point(), T(0)}, b{point(), point(), T(0)};
    const T skew = std::pow(T(10), T(-k % 12));
    if (k % 3 == 0) b = {a.from + skew * point(), a.to + skew * point(), T(0)};  // along each other
    if (k % 3 == 1) b.to = b.from + skew * point();                              // nearly a point
    const auto exact = [](const Xyz<T>& x) {
      return Xyz<Digits50>{Digits50(x.x), Digits50(x.y), Digits50(x.z)};
    };
    const Digits50 true_distance = distance(Capsule<Digits50>{exact(a.from), exact(a.to), 0},
                                            Capsule<Digits50>{exact(b.from), exact(b.to), 0})
                                       .distance;
    worst = std::max(worst, std::abs(static_cast<T>(Digits50(distance(a, b).distance) - true_distance)));
  }
  CAPTURE(worst / eps);
  CHECK(worst <= 8 * eps);
}

TEST_CASE("capsules: what is none is refused") {
  CHECK_NOTHROW(LinkCapsule{}.check(6));
  CHECK_THROWS_AS((LinkCapsule{.link = 6, .shape = {}}.check(6)), ConfigurationError);
  CHECK_THROWS_AS((LinkCapsule{.link = 0, .shape = {.radius = -1}}.check(6)), ConfigurationError);
  CHECK_THROWS_AS((LinkCapsule{.link = 0, .shape = {.from = {NAN, 0.0, 0.0}}}.check(6)), ConfigurationError);
}
