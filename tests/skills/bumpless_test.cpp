// Promise: skills change without a step, a day long
// Tried: all 90 ordered pairs of ten skills, 180 000 changes in double and float, touched meanwhile: a
// change adds 0.25 N m at most to a step of the torque, and moves it by 1022 N m/s where 1000 is
// configured (5 of 36 000 within 0.2 s of another goal: up to 1.6 N m, as a sample of one motion has);
// 24 h at 1 kHz in float: integrals bounded, 4e-11 rad of drift at rest. Also: `skills/`, studies
// `bumpless`, `nightly`

#include <doctest/doctest.h>

#include "tests/support/skilled_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// A part of bench/studies/bumpless.cpp, which changes a thousand times between each two.
TEST_CASE("SkillSet: no change of skill jumps, in torque or rate, at any state and under any touch") {
  const double dt = 0.002;
  const auto set = skilled_arm<double>(dt);
  using Set = std::remove_const_t<decltype(set)>;
  static_assert(Set::skills == (sanitized ? 2 : 10));
  const std::uint64_t trials = 3;
  for (std::uint8_t from = 0; from < Set::skills; ++from)
    for (std::uint8_t to = 0; to < Set::skills; ++to)
      for (std::uint64_t seed = 0; seed < trials && from != to; ++seed) {
        CAPTURE(set.skill(from).name);
        CAPTURE(set.skill(to).name);
        CAPTURE(seed);
        const auto b = bump<double>(set, from, to, seed, dt);
        CHECK(b.finite);
        CHECK(b.jump <= bump_bounds.jump);
        CHECK(b.kink <= bump_bounds.kink);
        CHECK(b.rate <= bump_bounds.rate);
        CHECK(b.time <= bump_bounds.time);
      }
}
