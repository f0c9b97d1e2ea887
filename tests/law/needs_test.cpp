#include "skinctl/law/needs.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace skinctl;

namespace {

constexpr Needs nothing{};
constexpr Needs a{.poses = 0b0101, .gravity = true};
constexpr Needs b{.poses = 0b0011, .jacobians = 0b1000, .touch = true};

// A template argument: what a scene needs is part of its type.
template <Needs>
struct Scene {};
static_assert(!std::is_same_v<Scene<a>, Scene<b>> && std::is_same_v<Scene<a | b>, Scene<b | a>>);

static_assert((a | nothing) == a && (a | a) == a && (a | b) == (b | a));
static_assert((a | b).poses == 0b0111 && (a | b).jacobians == 0b1000);
static_assert((a | b).gravity && (a | b).touch && !(a | b).mass && !(a | b).coriolis && !(a | b).angles);
static_assert((a | b).cover(a) && (a | b).cover(b) && (a | b).cover(nothing));
static_assert(!a.cover(b) && !b.cover(a) && !nothing.cover(a) && a.cover(nothing));

}  // namespace

TEST_CASE("Needs: each flag alone is covered by itself only") {
  const Needs each[] = {{.poses = 1},       {.jacobians = 1}, {.angles = true},
                        {.gravity = true},  {.mass = true},   {.mass_factors = true},
                        {.coriolis = true}, {.touch = true},  {.middle = true}};
  for (const Needs& x : each)
    for (const Needs& y : each) CHECK(x.cover(y) == (&x == &y));
}
