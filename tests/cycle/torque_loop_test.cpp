// Closed loops by torque with the default gains: the declared delay, and masses that are not as told.
//
// Promise: by torque the default gains suit the declared delay
// Tried: UR5 and a 7-joint arm, 1 to 8 ms, delays to 20 ms: at rest within 2 mrad, also with 1.5 and 2 kg
// told but not gripped; rotors that nobody declared: no joint above 1 rad/s. Of 40 arms, and 900 in the
// study, with none, half or all of their payload told and as much carried, and 4 N m of friction, none
// runs away. Also: study `torque`

#include "tests/support/torque_loop.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace skinctl;
using namespace skinctl::testing;

namespace {
constexpr double fastest = 0.75;  ///< [rad/s]: the spline's peak is 0.5
}  // namespace

TEST_CASE("by torque: the default gains suit the delay that is declared, and the arm rests") {
  for (const auto& loop : {Loop{1ms, 0ms}, {1ms, 5ms}, {1ms, 6ms}, {2ms, 8ms}, {2ms, 12ms}, {8ms, 20ms}})
    for (const double rotors : {0.0, 0.1}) {
      CAPTURE(milliseconds(loop.period));
      CAPTURE(milliseconds(loop.delay));
      CAPTURE(rotors);
      const Seen seen = reach<Ur5>({.loop = loop, .rotors = rotors, .real_rotors = rotors});
      CHECK(seen.peak < fastest);
      CHECK(seen.late < 1e-3);
      CHECK(seen.off < 2e-3);
    }
}

TEST_CASE(
    "by torque: the governor counts declared rotors: a wrist that sticks is not held, nor let run when it "
    "breaks") {
  for (const auto& loop : {Loop{1ms, 6ms}, {3ms, 2ms}, {7ms, 2ms}}) {
    CAPTURE(milliseconds(loop.period));
    const Seen seen = reach<Ur5>({.loop = loop, .rotors = 0.1, .real_rotors = 0.1, .friction = 4});
    CHECK(seen.peak < fastest);
    CHECK(seen.off < 0.03);
  }
}

TEST_CASE("by torque: with rotors that nobody declared no joint runs away") {
  for (const auto& loop : {Loop{1ms, 6ms}, {2ms, 8ms}, {2ms, 12ms}, {8ms, 20ms}}) {
    CAPTURE(milliseconds(loop.period));
    CAPTURE(milliseconds(loop.delay));
    CHECK(reach<Ur5>({.loop = loop, .real_rotors = 0.05}).peak < 1);
  }
}

TEST_CASE("by torque: a payload that is told but not in the gripper, and one that is there untold, rest") {
  for (const double rotors : {0.0, 0.05})  // undeclared
    for (const double mass : {1.5, 2.0}) {
      CAPTURE(rotors);
      CAPTURE(mass);
      const Seen lost = reach<Seven>({.loop = fr3_loop, .told = mass, .real_rotors = rotors});
      CHECK(lost.peak < fastest);
      CHECK(lost.late < 1e-3);
      CHECK(lost.off < 2e-3);
      CHECK(reach<Seven>({.loop = fr3_loop, .carried = mass, .real_rotors = rotors}).peak < 1);
    }
}

TEST_CASE("by torque: gains for a robot that may be lighter than told hold a payload that is lost") {
  for (const double mass : {0.0, 1.5, 3.0})
    for (const double carried : {0.0, 0.5 * mass, mass})
      for (const auto& loop : {Loop{1ms, 2ms}, {2ms, 8ms}}) {
        CAPTURE(mass);
        CAPTURE(carried);
        CAPTURE(milliseconds(loop.period));
        const Seen seen = reach<Seven>({.loop = loop,
                                        .told = mass,
                                        .carried = carried,
                                        .rotors = 0.1,
                                        .real_rotors = 0.1,
                                        .may_be_empty = true});
        CHECK(seen.peak < 1);
        CHECK(seen.late < 5e-3);
      }
  // Without the rotors' inertia the wrist may be lighter by any factor.
  const std::string why = Tried<Seven>({.loop = fr3_loop, .told = 3, .may_be_empty = true}).refused;
  CAPTURE(why);
  CHECK(why.find("mass ratio = ") != std::string::npos);
  CHECK(why.find("declare the rotors' inertia") != std::string::npos);
}

TEST_CASE("by torque: of 40 arms with any delay, friction and payload none runs away; refused ones say why") {
  auto random = seeded(40);
  int refused = 0;
  const auto look = [&]<class Robot>(const Truth& t, const Tried<Robot>& tried) {
    CAPTURE(milliseconds(t.loop.period));
    CAPTURE(milliseconds(t.loop.delay));
    CAPTURE(t.told);
    CAPTURE(t.carried);
    CAPTURE(t.friction);
    CAPTURE(tried.refused);
    CAPTURE(tried.seen.peak);
    CAPTURE(tried.seen.late);
    CHECK_FALSE(tried.seen.ran_away());
    if (tried.refused.empty()) return;
    ++refused;
    CHECK(t.told > 0);
    CHECK(tried.refused.find("declare the rotors' inertia") != std::string::npos);
  };
  for (int k = 0; k < 40; ++k) {
    const bool ur5 = k % 2 == 0;
    auto t = random_truth(random, ur5 ? 5 : 3, ur5 || k % 4 == 1 ? 0.1 : 0);
    t.end = 5s;
    ur5 ? look(t, Tried<Ur5>(t)) : look(t, Tried<Seven>(t));
  }
  CHECK(refused > 0);
  CHECK(refused < 20);
}

TEST_CASE("by torque: a wrist's integral is held at its limit, the other joints' go on") {
  Truth t{.loop = {2ms, 2ms}, .rotors = 0.1, .real_rotors = 0.1, .friction = 4};
  auto gains = default_gains<Ur5>(t);
  const double free = reach<Ur5>(t, gains).off;
  CHECK(free < 5e-3);
  gains.integral_limit[5] = 0.5;
  gains.K_c = 1;  // 6 N m/rad: the spline's error alone does not move it
  gains.tb = 0s;
  const Seen held = reach<Ur5>(t, gains);
  CHECK(held.off > 0.25);
  CHECK(held.others < 0.02);
}
