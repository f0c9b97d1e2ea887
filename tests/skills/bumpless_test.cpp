#include <doctest/doctest.h>

#include "skilled_arm.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::test;

// All ordered pairs; bench/studies/bumpless.cpp runs a thousand of each.
TEST_CASE_TEMPLATE("SkillSet: no change of skill jumps, in torque or rate, at any state and under any touch",
                   T, float, double) {
  const T dt = T(0.002);
  const auto set = skilled_arm<T>(dt);
  using Set = std::remove_const_t<decltype(set)>;
  const std::uint64_t trials = sanitized ? 1 : 6;
  for (std::uint8_t from = 0; from < Set::skills; ++from)
    for (std::uint8_t to = 0; to < Set::skills; ++to)
      for (std::uint64_t seed = 0; seed < trials && from != to; ++seed) {
        CAPTURE(set.skill(from).name);
        CAPTURE(set.skill(to).name);
        CAPTURE(seed);
        const auto b = bump<T>(set, from, to, seed, dt);
        CHECK(b.finite);
        CHECK(b.jump <= bump_bounds<T>.jump);
        CHECK(b.kink <= bump_bounds<T>.kink);
        CHECK(b.rate <= bump_bounds<T>.rate);
      }
}
