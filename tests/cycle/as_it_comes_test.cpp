// Robots that are not as declared; the study as_it_comes runs ten thousand of them.
//
// Promise: a robot that is not as declared in many ways at once does not run away untouched, and is seldom
// pressed harder
// Tried: encoders off by up to 0.1 rad, a lag of up to 50 ms where 8 are declared, servos from 500 N
// m/rad, friction, jitter, a payload wrong by 5 kg; untouched, at goals, led by hand, on a wall, blocked.
// Of 10 000 (`as_it_comes 10000 100001`) 9553 are as promised; 374 press harder on a wall, mostly with a lag
// of which the job does not know; two, whose encoders are off by 51 and 91 mrad, slid along a finger by 0.86
// and 0.49 rad against it, by some newton metres. Also: study `as_it_comes`

#include "bench/studies/worlds/as_it_comes.hpp"

#include <doctest/doctest.h>

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE(
    "as it comes: untouched it moves by no more than its gap, it never runs away, and a touch is not much "
    "harder") {
  for (std::uint64_t seed = 1; seed <= (sanitized ? 5 : 30); ++seed) {
    const AsItComes c(seed);
    const auto r = run_as_it_comes(c, false), twin = run_as_it_comes(c, true);
    const AsItComesVerdict v(c, r, twin);
    CAPTURE(seed);
    CAPTURE(as_it_comes_scenes[static_cast<int>(c.scene)]);
    CHECK_FALSE(v.away);
    // A lead that is as much too short as the lag that is not declared damps a stiff tool less.
    const double undeclared = c.truth.lookahead + c.truth.lag - c.declared_lag;
    const bool late_on_wall = c.scene == AsItComesScene::wall && undeclared > 0.015;
    CHECK_FALSE((v.silent && !late_on_wall));
    CHECK_FALSE(v.early);
    CHECK_FALSE(v.moved);
    CHECK(r.goal_error <= 0.01);
    CHECK(v.late_ratio <= (late_on_wall ? 2.5 : 1.5));
    // Declared truly it stays, arrives and gives way.
    CHECK(twin.beyond <= 0);
    CHECK(twin.goal_error <= 0.002);
    CHECK(twin.valid);
    if (c.scene == AsItComesScene::led) CHECK(twin.late < 40);
  }
}

TEST_CASE(
    "as it comes: servos that give way and stick are led not much harder than if their lag was declared") {
  int late = 0;
  for (const std::uint64_t seed : {517u, 1227u, 2798u, 3288u, 3578u}) {
    const AsItComes c(seed);
    const auto r = run_as_it_comes(c, false), twin = run_as_it_comes(c, true);
    CAPTURE(seed);
    late += AsItComesVerdict(c, r, twin).late;
    CHECK(r.late <= 3.5 * twin.late);
    if (sanitized) break;
  }
  CHECK(late <= 2);  // friction that needs more than the dead band of 0.02 rad
}

TEST_CASE("as it comes: nobody is asked about the gap of encoders") {
  for (const std::uint64_t seed : {502u, 802u, 2798u}) {
    AsItComes c(seed);
    CAPTURE(seed);
    CHECK(run_as_it_comes(c, false).consents == 0);
    c.reports_held = true;
    const auto r = run_as_it_comes(c, false);
    CHECK(r.consents == 0);
    CHECK(r.beyond <= 0);
    if (sanitized) break;
  }
}
