#include "skinctl/tactile/link_wrenches.hpp"

#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/robots/ur5.hpp"
#include "tests/support/random_frames.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Two = LinkWrenches<ur5::Model, 0b100100, double>;
}  // namespace

static_assert(std::is_trivially_copyable_v<Two>);
static_assert(sizeof(Two) == 2 * 6 * sizeof(double));
static_assert(Two::slot(2) == 0 && Two::slot(5) == 1);
static_assert(Two::count == 2 && LinkWrenches<ur5::Model, 0, double>::count == 0);

TEST_CASE_TEMPLATE("LinkWrenches: zero by default, and a vector space", T, float, double) {
  using W = LinkWrenches<ur5::Model, 0b100100, T>;
  Random rng = seeded(1);
  W a, b;
  CHECK(a == W{});
  CHECK(dot(a.template wrench<2>().force, a.template wrench<2>().force) == T(0));
  const Wrench<Link<2>, Link<2>, Link<2>, T> F{random_xyz<T>(rng, T(3)), random_xyz<T>(rng, T(3))};
  const Wrench<Link<5>, Link<5>, Link<5>, T> G{random_xyz<T>(rng, T(3)), random_xyz<T>(rng, T(3))};
  a.template set<2>(F);
  b.template set<5>(G);
  const W c = a + b;
  CHECK(c.template wrench<2>().force == F.force);
  CHECK(c.template wrench<2>().moment == F.moment);
  CHECK(c.template wrench<5>().force == G.force);
  CHECK(c.template wrench<5>().moment == G.moment);
  CHECK(T(2) * c == c + c);
  CHECK(c - a == b);
  W d = a;
  d += b;
  CHECK(d == c);
  CHECK_FALSE(a == b);
}
